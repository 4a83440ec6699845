/* What the calls on each device answer, as docs/linux-calls.md states it. A line for each that differs. */
#define _GNU_SOURCE
#include "serial.h"
#include <errno.h>
#include <limits.h>
#include <linux/fs.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <linux/serial.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <stdint.h>
#include <sys/epoll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <time.h>

static int checked, wrong;
static void expect(int line, const char* what, long result, int error, long wanted, int wanted_error) {
    checked++;
    if (result == wanted && (wanted_error == 0 || error == wanted_error)) return;
    wrong++;
    printf("%d: %s: %ld (%s), not %ld (%s)\n", line, what, result, result < 0 ? strerror(error) : "", wanted,
           wanted_error != 0 ? strerror(wanted_error) : "");
}
#define GIVES(call, wanted)                                                                                  \
    do {                                                                                                     \
        errno = 0;                                                                                           \
        const long got = (long)(call);                                                                       \
        expect(__LINE__, #call, got, errno, (long)(wanted), 0);                                              \
    } while (0)
#define FAILS(call, error)                                                                                   \
    do {                                                                                                     \
        errno = 0;                                                                                           \
        const long got = (long)(call);                                                                       \
        expect(__LINE__, #call, got, errno, -1, error);                                                      \
    } while (0)

static void* volatile nowhere;
static volatile int below = -1;

static char* bad(void) { /* a page that is not there, behind one that is */
    static char* page;
    if (page == NULL) {
        page = mmap(NULL, 8192, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        munmap(page + 4096, 4096);
    }
    return page + 4096;
}

static void any_terminal(int fd) { /* holds on a pty of the host too */
    char byte;
    struct iovec part = {&byte, 1};
    struct stat status;
    FAILS(lseek(fd, 0, SEEK_CUR), ESPIPE);
    FAILS(lseek(fd, 0, SEEK_SET), ESPIPE);
    FAILS(pread(fd, &byte, 1, 0), ESPIPE);
    FAILS(pwrite(fd, "x", 1, 0), ESPIPE);
    FAILS(preadv(fd, &part, 1, 0), ESPIPE);
    FAILS(ftruncate(fd, 0), EINVAL);
    FAILS(fsync(fd), EINVAL);
    FAILS((long)mmap(NULL, 4096, PROT_READ, MAP_SHARED, fd, 0), ENODEV);
    GIVES(fstat(fd, &status), 0);
    GIVES(S_ISCHR(status.st_mode), 1);
    GIVES(status.st_size, 0);
    GIVES(isatty(fd), 1);
    GIVES(fcntl(fd, F_GETFL) & O_ACCMODE, O_RDWR);
    GIVES(fcntl(fd, F_SETFL, O_APPEND | O_NONBLOCK), 0);
    GIVES(fcntl(fd, F_GETFL) & (O_APPEND | O_NONBLOCK), O_APPEND | O_NONBLOCK);
    FAILS(read(fd, &byte, 1), EAGAIN);
    GIVES(fcntl(fd, F_SETFL, O_NONBLOCK), 0);
    GIVES(read(fd, &byte, 0), 0);
    GIVES(write(fd, "", 0), 0);
    part.iov_len = 0;
    GIVES(pwritev2(fd, &part, 1, -1, RWF_SYNC | RWF_APPEND), 0);
    part.iov_len = 1;
    if (sizeof(long) == 8) GIVES(fcntl(fd, F_GETFL) & 0100000, 0100000);
    GIVES(fcntl(fd, F_NOTIFY, 0L), 0);
    FAILS(fcntl(fd, F_NOTIFY, (long)DN_MODIFY), ENOTDIR);
    const struct winsize wanted = {24, 80, 0, 0};
    struct winsize window = {0, 0, 0, 0};
    int number = 0;
    GIVES(ioctl(fd, TIOCSWINSZ, &wanted), 0);
    GIVES(ioctl(fd, TIOCGWINSZ, &window), 0);
    GIVES(window.ws_col * 100 + window.ws_row, 8024);
    GIVES(ioctl(fd, TIOCEXCL), 0);
    GIVES(ioctl(fd, TIOCGEXCL, &number), 0);
    GIVES(number, 1);
    GIVES(ioctl(fd, TIOCNXCL), 0);
    GIVES(ioctl(fd, TIOCGEXCL, &number), 0);
    GIVES(number, 0);
    GIVES(ioctl(fd, FIGETBSZ, &number), 0);
    FAILS(write(fd, bad(), 5), EFAULT);
    FAILS(write(fd, nowhere, 5), EFAULT);
    FAILS(read(fd, (void*)(intptr_t)below, 5), EFAULT);
    FAILS(writev(fd, (void*)bad(), 1), EFAULT);
    FAILS(readv(fd, &part, below), EINVAL);
    FAILS(ioctl(fd, TCGETS, bad()), EFAULT);
    FAILS(ioctl(fd, TCGETS, nowhere), EFAULT);
    FAILS(ioctl(fd, TCSETS, bad()), EFAULT);
    FAILS(ioctl(fd, TCSETSW, nowhere), EFAULT);
    FAILS(ioctl(fd, FIONREAD, bad()), EFAULT);
    FAILS(ioctl(fd, TIOCOUTQ, bad()), EFAULT);
    FAILS(ioctl(fd, FIONBIO, bad()), EFAULT);
    FAILS(ioctl(fd, TIOCGWINSZ, bad()), EFAULT);
    FAILS(ioctl(fd, TIOCGETD, bad()), EFAULT);
    FAILS(tcflush(fd, 17), EINVAL);
    FAILS(tcflow(fd, 17), EINVAL);
    FAILS(tcsetattr(fd, 17, &(struct termios){0}), EINVAL);
    FAILS(poll((void*)bad(), 1, 0), EFAULT);
    FAILS(open("/dev/ttyS0/x", O_RDWR), ENOTDIR);
}

static void serial(void) {
    const int fd = open_serial(1, 0);
    struct stat status;
    struct timespec before, after;
    int number = 0;
    any_terminal(fd);
    GIVES(fstat(fd, &status), 0);
    GIVES(status.st_rdev, makedev(4, 64));
    GIVES(stat("/dev/ttyS0", &status), 0);
    GIVES(status.st_rdev, makedev(4, 64));
    GIVES(fstatat(AT_FDCWD, "/dev/ttyS0", &status, 0), 0);
    GIVES(status.st_rdev, makedev(4, 64));
    FAILS(open((char*)bad(), O_RDWR), EFAULT);
    FAILS(open("/dev/ttyS0", O_RDWR | O_DIRECTORY), ENOTDIR);
    FAILS(open("/dev/ttyS0", O_RDWR | O_CREAT | O_EXCL, 0600), EEXIST);
    FAILS(ioctl(fd, TIOCMGET, bad()), EFAULT);
    FAILS(ioctl(fd, TIOCMSET, bad()), EFAULT);
    FAILS(ioctl(fd, TIOCGICOUNT, bad()), EFAULT);
    FAILS(ioctl(fd, TIOCGSERIAL, bad()), EFAULT);
    FAILS(ioctl(fd, TIOCSTI, bad()), EFAULT);
    char inserted = 'x';
    GIVES(ioctl(fd, TIOCSTI, &inserted), 0);
    GIVES(ioctl(fd, FIONREAD, &number), 0);
    GIVES(number, 1);
    GIVES(read(fd, &inserted, 1), 1);
    FAILS(ioctl(fd, I2C_SLAVE, 3), ENOTTY);
    FAILS(sendfile(fd, fd, NULL, 10), EINVAL);
    GIVES(fchmod(fd, 0600), 0);
    GIVES(stat("/dev/null", &status), 0);
    GIVES(status.st_mode & 0777, 0666);
    FAILS(unlink("/dev/ttyS0"), EPERM);
    GIVES(flock(fd, LOCK_EX | LOCK_NB), 0);
    GIVES(fcntl(fd, F_SETLK, &((struct flock){.l_type = F_WRLCK})), 0);
    GIVES(ioctl(fd, TIOCEXCL), 0);
    const int other = open("/dev/ttyS0", O_RDWR);
    GIVES(other >= 0, 1); /* a superuser may */
    close(other);
    GIVES(fcntl(fd, F_SETFL, O_ASYNC), 0);
    GIVES(write(fd, bad() - 2048, 4000), 2048); /* the tty takes pieces of so much */
    FAILS(write(fd, bad() - 2047, 4000), EFAULT);
    GIVES(tcdrain(fd), 0);
    /* a break takes its time, after what was written */
    clock_gettime(CLOCK_MONOTONIC, &before);
    GIVES(write(fd, "0123456789", 10), 10);
    GIVES(tcsendbreak(fd, 0), 0);
    clock_gettime(CLOCK_MONOTONIC, &after);
    long ms = (after.tv_sec - before.tv_sec) * 1000 + (after.tv_nsec - before.tv_nsec) / 1000000;
    GIVES(ms, 250);
    GIVES(ioctl(fd, TCSBRKP, 3), 0);
    clock_gettime(CLOCK_MONOTONIC, &before);
    ms = (before.tv_sec - after.tv_sec) * 1000 + (before.tv_nsec - after.tv_nsec) / 1000000;
    GIVES(ms, 300);
    close(fd);
    FAILS(read(fd, &status, 1), EBADF);
}

static long smbus(int fd, int rw, int command, int size, void* data) {
    struct i2c_smbus_ioctl_data call = {(uint8_t)rw, (uint8_t)command, (uint32_t)size, data};
    return ioctl(fd, I2C_SMBUS, &call);
}

static long rdwr(int fd, int flags, int length, void* buffer, unsigned count) {
    struct i2c_msg message = {0x60, (uint16_t)flags, (uint16_t)length, buffer};
    struct i2c_rdwr_ioctl_data call = {&message, count};
    return ioctl(fd, I2C_RDWR, &call);
}

static void i2c(void) {
    static unsigned char big[9000];
    const int fd = open("/dev/i2c-3", O_RDWR);
    unsigned long functions = 0;
    union i2c_smbus_data data;
    memset(&data, 0, sizeof data);
    GIVES(ioctl(fd, I2C_FUNCS, &functions), 0);
    GIVES(functions,
          I2C_FUNC_I2C | I2C_FUNC_PROTOCOL_MANGLING | (I2C_FUNC_SMBUS_EMUL & ~I2C_FUNC_SMBUS_QUICK));
    FAILS(ioctl(fd, I2C_FUNCS, bad()), EFAULT);
    FAILS(ioctl(fd, I2C_SLAVE, 0x80), EINVAL);
    GIVES(ioctl(fd, I2C_SLAVE, 0x60), 0);
    GIVES(ioctl(fd, I2C_PEC, 0), 0);
    FAILS(ioctl(fd, I2C_TIMEOUT, -1L), EINVAL);
    FAILS(ioctl(fd, I2C_RETRIES, -1L), EINVAL);
    FAILS(ioctl(fd, TCGETS, big), ENOTTY);
    FAILS(lseek(fd, 0, SEEK_SET), ESPIPE);
    FAILS(read(fd, big, 0), EINVAL);
    FAILS(write(fd, big, 0), EINVAL);
    FAILS(write(fd, bad(), 3), EFAULT);
    FAILS(read(fd, bad(), 3), EFAULT);
    FAILS(rdwr(fd, 0, 1, big, 0), EINVAL);
    FAILS(rdwr(fd, 0, 1, big, 43), EINVAL);
    FAILS(rdwr(fd, 0, 8193, big, 1), EINVAL);
    FAILS(rdwr(fd, 0, 0, big, 1), EINVAL);
    FAILS(rdwr(fd, I2C_M_RD, 0, big, 1), EINVAL);
    FAILS(rdwr(fd, 0, 3, bad(), 1), EFAULT);
    FAILS(rdwr(fd, I2C_M_RD, 3, bad(), 1), EFAULT);
    FAILS(rdwr(fd, I2C_M_RECV_LEN, 40, big, 1), EINVAL);
    GIVES(rdwr(fd, I2C_M_RD, 8192, big, 1), 1);
    FAILS(ioctl(fd, I2C_RDWR, bad()), EFAULT);
    FAILS(ioctl(fd, I2C_RDWR, &((struct i2c_rdwr_ioctl_data){NULL, 1})), EINVAL);
    FAILS(ioctl(fd, I2C_RDWR, &((struct i2c_rdwr_ioctl_data){(void*)bad(), 1})), EFAULT);
    FAILS(ioctl(fd, I2C_SMBUS, bad()), EFAULT);
    FAILS(smbus(fd, 2, 0, I2C_SMBUS_BYTE, &data), EINVAL);
    FAILS(smbus(fd, I2C_SMBUS_READ, 0, 9, &data), EINVAL);
    FAILS(smbus(fd, I2C_SMBUS_READ, 0, -1, &data), EINVAL);
    FAILS(smbus(fd, I2C_SMBUS_READ, 0, I2C_SMBUS_BYTE_DATA, NULL), EINVAL);
    FAILS(smbus(fd, I2C_SMBUS_READ, 0, I2C_SMBUS_BYTE_DATA, bad()), EFAULT);
    FAILS(smbus(fd, I2C_SMBUS_WRITE, 0, I2C_SMBUS_WORD_DATA, bad()), EFAULT);
    FAILS(smbus(fd, I2C_SMBUS_WRITE, 0, I2C_SMBUS_QUICK, NULL), EINVAL);
    data.block[0] = I2C_SMBUS_BLOCK_MAX + 1;
    FAILS(smbus(fd, I2C_SMBUS_WRITE, 0, I2C_SMBUS_BLOCK_DATA, &data), EINVAL);
    FAILS(smbus(fd, I2C_SMBUS_WRITE, 0, I2C_SMBUS_I2C_BLOCK_DATA, &data), EINVAL);
    data.block[0] = 0;
    FAILS(smbus(fd, I2C_SMBUS_READ, 0, I2C_SMBUS_I2C_BLOCK_DATA, &data), EINVAL);
    /* with and without packet error code: the slave counts from 0x10 on, so the code is never right */
    GIVES(smbus(fd, I2C_SMBUS_READ, 0, I2C_SMBUS_BYTE_DATA, &data), 0);
    GIVES(data.byte, 0x10);
    GIVES(smbus(fd, I2C_SMBUS_READ, 0, I2C_SMBUS_WORD_DATA, &data), 0);
    GIVES(data.word, 0x1110);
    GIVES(ioctl(fd, I2C_PEC, 1), 0);
    FAILS(smbus(fd, I2C_SMBUS_READ, 0, I2C_SMBUS_BYTE_DATA, &data), EBADMSG);
    data.byte = 0x42;
    GIVES(smbus(fd, I2C_SMBUS_WRITE, 2, I2C_SMBUS_BYTE_DATA, &data), 0);
    GIVES(ioctl(fd, I2C_PEC, 0), 0);
    GIVES(smbus(fd, I2C_SMBUS_READ, 2, I2C_SMBUS_WORD_DATA, &data), 0);
    GIVES(data.word, 0x6e42); /* 0x6e: the CRC-8 of c0 02 42 */
    /* the adapter reads the count of a block alone */
    memset(&data, 0xff, sizeof data);
    GIVES(smbus(fd, I2C_SMBUS_READ, 4, I2C_SMBUS_BLOCK_DATA, &data), 0);
    GIVES(data.block[0], 0x14);
    GIVES(read(fd, big, 9000), 8192);
    GIVES(write(fd, big, 9000), 8192);
    FAILS(rdwr(fd, I2C_M_NOSTART, 2, big, 1), EOPNOTSUPP);
    struct i2c_msg two[] = {{0x60, 0, 8000, big}, {0x60, 0, 8000, big}};
    FAILS(ioctl(fd, I2C_RDWR, &((struct i2c_rdwr_ioctl_data){two, 2})), EOPNOTSUPP);
    struct stat status;
    GIVES(fstat(fd, &status), 0);
    GIVES(status.st_rdev, makedev(89, 3));
}

static void video(void) {
    static const unsigned long calls[] = {VIDIOC_QUERYCAP,
                                          VIDIOC_ENUM_FMT,
                                          VIDIOC_G_FMT,
                                          VIDIOC_S_FMT,
                                          VIDIOC_TRY_FMT,
                                          VIDIOC_REQBUFS,
                                          VIDIOC_QUERYBUF,
                                          VIDIOC_QBUF,
                                          VIDIOC_DQBUF,
                                          VIDIOC_STREAMON,
                                          VIDIOC_STREAMOFF,
                                          VIDIOC_G_PARM,
                                          VIDIOC_S_PARM,
                                          VIDIOC_ENUMINPUT,
                                          VIDIOC_G_INPUT,
                                          VIDIOC_S_INPUT,
                                          VIDIOC_QUERYCTRL,
                                          VIDIOC_G_CTRL,
                                          VIDIOC_S_CTRL,
                                          VIDIOC_QUERYMENU,
                                          VIDIOC_G_EXT_CTRLS,
                                          VIDIOC_S_EXT_CTRLS,
                                          VIDIOC_TRY_EXT_CTRLS,
                                          VIDIOC_ENUM_FRAMESIZES,
                                          VIDIOC_ENUM_FRAMEINTERVALS};
    const int fd = open("/dev/video1", O_RDWR);
    char byte;
    struct stat status;
    FAILS(write(fd, "x", 1), EINVAL);
    FAILS(lseek(fd, 0, SEEK_SET), ESPIPE);
    FAILS(ftruncate(fd, 0), EINVAL);
    FAILS(ioctl(fd, TCGETS, &status), ENOTTY);
    FAILS(ioctl(fd, _IOWR('V', 255, int), &status), ENOTTY);
    FAILS(open("/dev/video1", O_RDWR | O_DIRECTORY), ENOTDIR);
    for (unsigned i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        FAILS(ioctl(fd, calls[i], bad()), EFAULT);
        FAILS(ioctl(fd, calls[i], nowhere), EFAULT);
        FAILS(ioctl(fd, calls[i], bad() - 1), EFAULT);
    }
    struct v4l2_ext_controls list = {.count = 2, .controls = (void*)bad()};
    FAILS(ioctl(fd, VIDIOC_G_EXT_CTRLS, &list), EFAULT);
    FAILS(ioctl(fd, VIDIOC_S_EXT_CTRLS, &list), EFAULT);
    list.controls = nowhere;
    FAILS(ioctl(fd, VIDIOC_TRY_EXT_CTRLS, &list), EFAULT);
    FAILS(read(fd, bad(), 100), EFAULT);
    FAILS(read(fd, nowhere, 100), EFAULT);
    GIVES(read(fd, &byte, 1), 1);
    GIVES(fstat(fd, &status), 0);
    GIVES(S_ISCHR(status.st_mode), 1);
    GIVES(major(status.st_rdev), 81);
}

static void clocks(void) {
    struct timespec t;
    FAILS(clock_gettime(CLOCK_MONOTONIC, (void*)bad()), EFAULT);
    FAILS(clock_gettime(77, &t), EINVAL);
    FAILS(nanosleep((void*)bad(), NULL), EFAULT);
    t.tv_sec = 0;
    t.tv_nsec = 1000000000;
    FAILS(nanosleep(&t, NULL), EINVAL);
    GIVES(clock_nanosleep(CLOCK_THREAD_CPUTIME_ID, 0, &t, NULL), EINVAL);
    FAILS(gettimeofday((void*)bad(), NULL), EFAULT);
    FAILS(setitimer(ITIMER_REAL, (void*)bad(), NULL), EFAULT);
    FAILS(clock_settime(CLOCK_REALTIME, &t), EPERM);
    const int timer = timerfd_create(CLOCK_MONOTONIC, 0), set = epoll_create1(0);
    FAILS(timerfd_settime(timer, 0, (void*)bad(), NULL), EFAULT);
    FAILS(epoll_wait(set, (void*)bad(), 0, 0), EINVAL);
    FAILS(epoll_wait(timer, (void*)bad(), 1, 0), EINVAL);
    FAILS(waitpid(-1, NULL, 0), ECHILD);
    FAILS(select(-1, NULL, NULL, NULL, NULL), EINVAL);
    FAILS(select(1, (void*)bad(), NULL, NULL, NULL), EFAULT);
}

static void pty(void) { /* run on the host: what is expected of any terminal is what Linux does */
    const int fd = posix_openpt(O_RDWR | O_NOCTTY);
    if (fd < 0 || grantpt(fd) != 0 || unlockpt(fd) != 0) exit(77);
    const int slave = open(ptsname(fd), O_RDWR | O_NOCTTY);
    struct termios t;
    tcgetattr(slave, &t);
    cfmakeraw(&t);
    tcsetattr(slave, TCSANOW, &t);
    any_terminal(slave);
}

int main(int argc, char** argv) {
    (void)argc;
    if (strcmp(argv[1], "pty") == 0) pty();
    if (strcmp(argv[1], "serial") == 0) serial();
    if (strcmp(argv[1], "i2c") == 0) i2c();
    if (strcmp(argv[1], "video") == 0) video();
    if (strcmp(argv[1], "clocks") == 0) {
        close(open_serial(1, 0));
        clocks();
    }
    printf("%d checked, %d wrong\n", checked, wrong);
    return wrong != 0;
}
