"""Decodes a byte stream into messages, and resynchronises wherever the stream was cut."""

from __future__ import annotations

from typing import TYPE_CHECKING
from zlib import crc32

from pacinian_plugins.backends.usb_autd.frames import CRC, HEAD, HEADER, MAGIC, Frame, unpack
from pacinian_plugins.backends.usb_autd.protocol import MAJOR, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport


class Decoder:
    """Decodes the stream sent to a device.

    can: capability of the device. skipped: number of bytes that belong to no message.
    """

    def __init__(self, can: CapabilityReport) -> None:
        self.can = can
        self.skipped = 0
        self._buffer = bytearray()

    def flush(self) -> None:
        """Discard an incomplete message."""
        self._buffer.clear()

    def feed(self, data: bytes) -> Iterator[Frame | Verdict]:
        """Yield frames, or the verdict on invalid messages, in stream order. Consume all of them."""
        buffer = self._buffer
        buffer += data
        while (found := self._header()) is not None:
            length, check = found
            if isinstance(check, Verdict):  # its length is unreliable: search after its magic
                yield check
                self._skip(1)
                continue
            if len(buffer) < length:
                return
            message = bytes(buffer[:length])
            end = length - CRC.size
            if crc32(memoryview(message)[HEAD:end], check) != CRC.unpack_from(message, end)[0]:
                yield Verdict.CORRUPT
                self._skip(1)
                continue
            del buffer[:length]
            yield unpack(message, self.can)

    def _header(self) -> tuple[int, int | Verdict] | None:
        """Find the next header; return its length and its CRC or verdict, or None if more bytes are needed."""
        buffer = self._buffer
        while True:
            at = buffer.find(MAGIC)
            if at < 0:
                ends = (n for n in range(len(MAGIC) - 1, -1, -1) if buffer.endswith(MAGIC[:n]))
                at = len(buffer) - next(ends)
            self._skip(at)
            if len(buffer) < HEAD:
                return None
            _, major, _, _, length, _, _ = HEADER.unpack_from(buffer)
            check = crc32(memoryview(bytes(buffer[: HEADER.size])))
            if check != CRC.unpack_from(buffer, HEADER.size)[0]:
                self._skip(1)
                continue
            if major != MAJOR:
                return 0, Verdict.VERSION
            fits = HEAD + CRC.size <= length <= self.can.longest
            return length, check if fits else Verdict.LENGTH

    def _skip(self, count: int) -> None:
        del self._buffer[:count]
        self.skipped += count
