# SPDX-License-Identifier: Apache-2.0
"""OpenIGTLink messages of version 1, from the protocol's specification alone (openigtlink.org, v2 header and
TRANSFORM pages): a head of 58 bytes, big endian, and a body whose CRC-64 (ECMA-182, from zero) it holds."""
import socket
import struct

HEAD = struct.Struct(">H12s20sQQQ")  # version, type, device, time stamp, size of the body, its CRC
_POLYNOMIAL = 0x42F0E1EBA9EA3693


def _crc_of_byte(byte):
    crc = byte << 56
    for _ in range(8):
        crc = (crc << 1 ^ (_POLYNOMIAL if crc >> 63 else 0)) & (1 << 64) - 1
    return crc


_TABLE = [_crc_of_byte(byte) for byte in range(256)]


def crc64(body):
    crc = 0
    for byte in body:
        crc = (crc << 8 & (1 << 64) - 1) ^ _TABLE[crc >> 56 ^ byte]
    return crc


def transform(device, position_ras):
    """A TRANSFORM without rotation: three axes, then the translation, mm."""
    body = struct.pack(">12f", 1, 0, 0, 0, 1, 0, 0, 0, 1, *position_ras)
    return HEAD.pack(1, b"TRANSFORM", device.encode(), 0, len(body), crc64(body)) + body


def receive(connection):
    """The next message as (type, device, body). Raises ValueError where its CRC does not fit."""
    _, kind, device, _, size, crc = HEAD.unpack(_exactly(connection, HEAD.size))
    body = _exactly(connection, size)
    if crc64(body) != crc:
        raise ValueError("a body that does not fit its CRC")
    return kind.rstrip(b"\0").decode(), device.rstrip(b"\0").decode(), body


def _exactly(connection, size):
    data = b""
    while len(data) < size:
        part = connection.recv(size - len(data))
        if not part:
            raise ConnectionError("the other end closed")
        data += part
    return data


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
