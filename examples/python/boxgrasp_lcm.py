"""LCM over UDP multicast for Python's standard library alone: publish and receive bytes on named channels.

Debian has no Python module of LCM; the wire format is small (https://lcm-proj.github.io, UDP multicast protocol).
"""
import socket
import struct
import time

GROUP = ("239.255.76.67", 7667)
SMALL, FRAGMENT = 0x4C433032, 0x4C433033
FRAGMENT_BYTES = 60000
RECEIVE_BUFFER_BYTES = 8 << 20


class Lcm:
    def __init__(self, group=GROUP, ttl=0):
        self.group, self.sequence, self.parts = group, 0, {}
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
        membership = socket.inet_aton(group[0]) + socket.inet_aton("0.0.0.0")
        self.socket.bind(group)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)

    def publish(self, channel, payload):
        name = channel.encode() + b"\0"
        self.sequence += 1
        if len(payload) <= FRAGMENT_BYTES:
            self.socket.sendto(struct.pack(">II", SMALL, self.sequence) + name + payload, self.group)
            return
        count = -(-len(payload) // FRAGMENT_BYTES)
        for i in range(count):
            offset = i * FRAGMENT_BYTES
            head = struct.pack(">IIIIHH", FRAGMENT, self.sequence, len(payload), offset, i, count)
            part = payload[offset : offset + FRAGMENT_BYTES]
            self.socket.sendto(head + (name if i == 0 else b"") + part, self.group)

    def receive(self, channel, timeout_s):
        """The next message on the channel, as bytes; None when there is none in time."""
        end = time.monotonic() + timeout_s
        while (left := end - time.monotonic()) > 0:
            self.socket.settimeout(left)
            try:
                packet, sender = self.socket.recvfrom(65536)
            except TimeoutError:
                break
            message = self._message(packet, sender)
            if message and message[0] == channel:
                return message[1]
        return None

    def _message(self, packet, sender):
        """(channel, payload) once a whole message is here, else None."""
        if len(packet) < 9:
            return None
        magic, sequence = struct.unpack(">II", packet[:8])
        if magic == SMALL:
            name, _, payload = packet[8:].partition(b"\0")
            return name.decode(errors="replace"), payload
        if magic != FRAGMENT or len(packet) < 20:
            return None
        size, _, number, count = struct.unpack(">IIHH", packet[8:20])
        if (sender, sequence) not in self.parts:
            self.parts = {key: parts for key, parts in self.parts.items() if key[0] != sender}
        parts = self.parts.setdefault((sender, sequence), {})
        parts[number] = packet[20:]
        if len(parts) < count:
            return None
        del self.parts[sender, sequence]
        name, _, payload = b"".join(parts.get(i, b"") for i in range(count)).partition(b"\0")
        return (name.decode(errors="replace"), payload) if len(payload) == size else None
