/* Prints what each of its calls on the serial port or the I2C adapter gave, and when:
     read N LENGTH | write N LENGTH | set | i2c N ADDRESS | tick N
   Knows nothing of any emulator, or of faults. */
#define _GNU_SOURCE
#include "serial.h"

#include <errno.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <sys/ioctl.h>
#include <time.h>

static double ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)(t.tv_sec - 60) * 1e3 + (double)t.tv_nsec * 1e-6;
}

static void say(const char* call, long result) {
    int error = errno;
    printf("%s %ld %s at %.1f ms\n", call, result, result < 0 ? strerrorname_np(error) : "", ms());
    fflush(stdout);
}

static void nap(void) {
    usleep(10000);
}

int main(int argc, char** argv) {
    const char* what = argc > 1 ? argv[1] : "";
    int count = argc > 2 ? atoi(argv[2]) : 0;
    int number = argc > 3 ? (int)strtol(argv[3], NULL, 0) : 1;
    char buffer[256];
    memset(buffer, 'U', sizeof buffer);
    if (strcmp(what, "i2c") == 0) {
        int bus = open("/dev/i2c-3", O_RDWR);
        for (int i = 0; i < count; i++) {
            unsigned char reg = 1, value = 0;
            struct i2c_msg messages[2] = {{(__u16)number, 0, 1, &reg}, {(__u16)number, I2C_M_RD, 1, &value}};
            struct i2c_rdwr_ioctl_data both = {messages, 2};
            int done = ioctl(bus, I2C_RDWR, &both);
            say("transfer", done < 0 ? done : value);
            nap();
        }
        return 0;
    }
    int port = open_serial(1, 0);
    if (strcmp(what, "set") == 0) {
        struct termios t;
        tcgetattr(port, &t);
        t.c_cflag |= PARENB | CSTOPB;
        int done = tcsetattr(port, TCSANOW, &t);
        tcgetattr(port, &t);
        printf("%d baud %d parity %d stop %d\n", done, cfgetospeed(&t) == B115200, (t.c_cflag & PARENB) != 0,
               (t.c_cflag & CSTOPB) != 0);
        say("write", write(port, "U", 1));
        nap();
        return 0;
    }
    for (int i = 0; i < count; i++) {
        if (strcmp(what, "read") == 0) {
            say("read", read(port, buffer, (size_t)number));
        } else if (strcmp(what, "write") == 0) {
            say("write", write(port, buffer, (size_t)number));
            nap();
        } else {
            say("tick", i);
            nap();
        }
    }
    return 0;
}
