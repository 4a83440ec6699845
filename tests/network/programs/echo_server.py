# Sends back every datagram.
import socket

place = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
place.bind(("", 7000))
while True:
    data, sender = place.recvfrom(2000)
    place.sendto(data, sender)
