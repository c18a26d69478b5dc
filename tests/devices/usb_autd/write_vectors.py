"""Writes vectors.json: python -m tests.devices.usb_autd.write_vectors."""

from tests.devices.usb_autd.cases import FILE, text

if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
