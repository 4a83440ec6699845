/* Opens the serial port as control programs do: 115200 8N1, raw. Knows nothing of any emulator. */
#pragma once
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

static int open_serial(int vmin, int vtime) {
    struct termios t;
    int fd = open("/dev/ttyS0", O_RDWR | O_NOCTTY);
    if (fd < 0 || tcgetattr(fd, &t) != 0) {
        perror("/dev/ttyS0");
        exit(3);
    }
    cfmakeraw(&t);
    cfsetspeed(&t, B115200);
    t.c_cflag |= CLOCAL | CREAD;
    t.c_cc[VMIN] = (cc_t)vmin;
    t.c_cc[VTIME] = (cc_t)vtime;
    if (tcsetattr(fd, TCSAFLUSH, &t) != 0) exit(3);
    return fd;
}
