/* Sends what it receives, each byte plus one, until a zero comes. */
#include "serial.h"

int main(void) {
    int fd = open_serial(1, 0);
    unsigned char b;
    while (read(fd, &b, 1) == 1 && b != 0) {
        b++;
        if (write(fd, &b, 1) != 1) return 4;
    }
    tcdrain(fd);
    close(fd);
    return 0;
}
