# SPDX-License-Identifier: Apache-2.0
"""What an Ogg file's Theora stream says of itself, read from its pages (RFC 3533; Theora specification, 6.2)."""


def packets_of(data):
    """The packets of a file with one stream."""
    packets, packet, at = [], b"", 0
    while at < len(data):
        if data[at:at + 4] != b"OggS":
            raise ValueError(f"no page at byte {at}")
        segments = data[at + 27:at + 27 + data[at + 26]]
        at += 27 + len(segments)
        for length in segments:
            packet += data[at:at + length]
            at += length
            if length < 255:
                packets.append(packet)
                packet = b""
    if at != len(data) or packet:
        raise ValueError("ends within a page or packet")
    return packets


def read_theora(data):
    """(width, height, pictures, pictures a second)"""
    head, comment, setup, *pictures = packets_of(data)
    if [p[:7] for p in (head, comment, setup)] != [b"\x80theora", b"\x81theora", b"\x82theora"]:
        raise ValueError("is no Theora stream")
    number = lambda first, end: int.from_bytes(head[first:end], "big")  # noqa: E731
    return number(14, 17), number(17, 20), len(pictures), number(22, 26) / number(26, 30)
