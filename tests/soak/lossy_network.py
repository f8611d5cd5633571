"""A bad network between two LCM ports: drops and reorders datagrams. (Not every kernel has tc's netem.)"""
import random
import selectors
import socket
import struct
import threading
import time

GROUP = "239.255.76.67"


def listener(port):
    found = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 32 << 20)
    found.bind((GROUP, port))
    found.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, struct.pack("4s4s", socket.inet_aton(GROUP), socket.inet_aton("127.0.0.1")))
    return found


class LossyNetwork:
    """Carries what is sent to either port to the other, until it is closed."""

    def __init__(self, ports, drop, reorder, seed=1):
        self.drop, self.reorder, self.random = drop, reorder, random.Random(seed)
        self.selector, self.senders, self.own = selectors.DefaultSelector(), {}, set()
        self.carried = self.dropped = self.reordered = 0
        self.held = []  # (when to send, sender, datagram, port)
        for port, other in (ports, ports[::-1]):
            self.selector.register(listener(port), selectors.EVENT_READ, other)
        self.running = True
        self.thread = threading.Thread(target=self._carry, daemon=True)
        self.thread.start()

    def close(self):
        self.running = False
        self.thread.join()

    def sender(self, source, port):
        """A socket for each original sender: LCM puts fragments together by where they come from."""
        if (source, port) not in self.senders:
            made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            made.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            made.bind(("127.0.0.1", 0))
            self.senders[source, port] = made
            self.own.add(made.getsockname())
        return self.senders[source, port]

    def _carry(self):
        while self.running:
            for key, _ in self.selector.select(0.002):
                datagram, source = key.fileobj.recvfrom(65536)
                if source not in self.own:
                    self._pass(datagram, source, key.data)
            now = time.monotonic()
            due, self.held = [one for one in self.held if one[0] <= now], [one for one in self.held if one[0] > now]
            for _, sender, late, port in due:
                sender.sendto(late, (GROUP, port))

    def _pass(self, datagram, source, port):
        if self.random.random() < self.drop:
            self.dropped += 1
            return
        self.carried += 1
        sender = self.sender(source, port)
        if self.random.random() < self.reorder:
            self.reordered += 1
            self.held.append((time.monotonic() + 0.005, sender, datagram, port))
        else:
            sender.sendto(datagram, (GROUP, port))
