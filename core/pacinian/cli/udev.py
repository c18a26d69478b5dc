"""The udev rule for the arrays of the installed backends."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from pacinian.plugins.backend import Backend
    from pacinian.plugins.registry import Plugins

HEAD = """\
# Ultrasound arrays for Pacinian. Goes to /etc/udev/rules.d/72-pacinian.rules: `uaccess` is looked at by
# 73-seat-late.rules, so the name must sort below it. Then: sudo udevadm control --reload && sudo udevadm trigger
# For a server without a seat, add to each line: GROUP="plugdev", MODE="0660"
"""
RULE = (
    'SUBSYSTEM=="usb", ENV{{DEVTYPE}}=="usb_device", ATTR{{idVendor}}=="{:04x}", '
    'ATTR{{idProduct}}=="{:04x}", TAG+="uaccess", TEST=="power/control", ATTR{{power/control}}="on"\n'
)


def rules(plugins: Plugins) -> str:
    """The text of the rule, with a line for each kind of USB device."""
    plugins.load()
    text = HEAD
    for (kind, name), offer in sorted(plugins.offers.items()):
        if kind == "backend" and (usb := cast("type[Backend]", offer.cls).usb):
            text += f"\n# {name}\n" + "".join(RULE.format(*pair) for pair in usb)
    return text
