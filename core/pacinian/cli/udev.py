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
    'SUBSYSTEM=="usb", ENV{{DEVTYPE}}=="usb_device", {}, TAG+="uaccess", '
    'TEST=="power/control", ATTR{{power/control}}="on"\n'
)


def make_rules(plugins: Plugins) -> str:
    """The text of the rule, with a line for each kind of USB device."""
    plugins.load(kind="backend")
    text = HEAD
    for (kind, name), offer in sorted(plugins.offers.items()):
        if kind == "backend" and (usb := cast("type[Backend]", offer.cls).usb):
            text += f"\n# {name}\n" + "".join(RULE.format(_match(numbers)) for numbers in usb)
    return text


def _match(numbers: tuple[int, ...]) -> str:
    """Vendor and product, or class, subclass and protocol of an interface."""
    if len(numbers) == 2:
        return 'ATTR{{idVendor}}=="{:04x}", ATTR{{idProduct}}=="{:04x}"'.format(*numbers)
    return 'ENV{{ID_USB_INTERFACES}}=="*:{:02x}{:02x}{:02x}:*"'.format(*numbers)
