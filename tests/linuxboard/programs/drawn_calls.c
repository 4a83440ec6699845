/* Calls with arguments drawn from a seed: drawn_calls SEED CALLS. Each ends with a result or with one of the
   errors that docs/linux-calls.md lists for it; no signal comes, and the host's files stay as they are. */
#define _GNU_SOURCE
#include "serial.h"
#include <errno.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <sys/epoll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/sendfile.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/times.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <time.h>

static uint64_t state;
static long wrong;

static unsigned draw(unsigned below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(state >> 33) % below;
}

static struct termios usual;
static char* pages;          /* one that can be written, one that can be read, one that is not there */
static int fds[8], fd_count; /* the last is the camera's */

static void* pointer(void) {
    switch (draw(9)) {
    case 0:
        return NULL;
    case 1:
        return (void*)(intptr_t)-1;
    case 2:
        return (void*)(intptr_t)(draw(4096));
    case 3:
        return (void*)0xffff800000000000u;
    case 4:
        return pages + 4096 + draw(4096); /* read-only */
    case 5:
        return pages + 8192 - draw(16); /* into what is not there */
    case 6:
        return pages + 8192 + draw(4096);
    default:
        return pages + draw(2048);
    }
}

static size_t size(void) {
    static const size_t sizes[] = {0, 1, 2, 5, 32, 100, 2048, 4096, 8192, 8193, 20000, 1u << 31, SIZE_MAX};
    return sizes[draw(sizeof sizes / sizeof sizes[0])];
}

static int some_fd(void) {
    static const int odd[] = {-1, 9999, 500, 501}; /* the last two: the library's own */
    return draw(8) == 0 ? odd[draw(4)] : fds[draw((unsigned)fd_count)];
}

static unsigned long request(void) {
    static const unsigned long known[] = {TCGETS,
                                          TCSETS,
                                          TCSETSW,
                                          TCSETSF,
                                          TCGETA,
                                          TCSETA,
                                          TCFLSH,
                                          TCXONC,
                                          FIONREAD,
                                          TIOCOUTQ,
                                          TIOCMGET,
                                          TIOCMSET,
                                          TIOCMBIS,
                                          TIOCMBIC,
                                          TIOCGSERIAL,
                                          TIOCSSERIAL,
                                          TIOCGICOUNT,
                                          TIOCGWINSZ,
                                          TIOCSWINSZ,
                                          TIOCGETD,
                                          TIOCSETD,
                                          TIOCEXCL,
                                          TIOCNXCL,
                                          TIOCGSOFTCAR,
                                          FIONBIO,
                                          FIOASYNC,
                                          I2C_SLAVE,
                                          I2C_SLAVE_FORCE,
                                          I2C_FUNCS,
                                          I2C_RDWR,
                                          I2C_SMBUS,
                                          I2C_TIMEOUT,
                                          I2C_RETRIES,
                                          I2C_PEC,
                                          I2C_TENBIT,
                                          VIDIOC_QUERYCAP,
                                          VIDIOC_S_FMT,
                                          VIDIOC_G_FMT,
                                          VIDIOC_ENUM_FMT,
                                          VIDIOC_REQBUFS,
                                          VIDIOC_QBUF,
                                          VIDIOC_QUERYBUF,
                                          VIDIOC_STREAMON,
                                          VIDIOC_STREAMOFF,
                                          VIDIOC_G_EXT_CTRLS,
                                          VIDIOC_S_EXT_CTRLS,
                                          VIDIOC_QUERYCTRL,
                                          VIDIOC_S_PARM};
    return draw(20) == 0 ? (unsigned long)draw(65536) : known[draw(sizeof known / sizeof known[0])];
}

/* An I2C call whose inner pointers may be bad. */
static void* i2c_argument(unsigned long number) {
    static struct i2c_msg messages[44];
    static struct i2c_rdwr_ioctl_data rdwr;
    static struct i2c_smbus_ioctl_data smbus;
    if (number == I2C_RDWR) {
        for (unsigned i = 0; i < 44; i++) {
            messages[i].addr = draw(2) ? 0x60 : (uint16_t)draw(128);
            messages[i].flags = draw(4) ? (uint16_t)draw(2) : (uint16_t)draw(65536);
            messages[i].len = draw(8) ? (uint16_t)draw(5) : (uint16_t)draw(9000);
            messages[i].buf = pointer();
        }
        rdwr.msgs = draw(10) ? messages : pointer();
        rdwr.nmsgs = draw(4) ? 1 + draw(3) : draw(60);
        return &rdwr;
    }
    smbus.read_write = (uint8_t)draw(3);
    smbus.command = (uint8_t)draw(256);
    smbus.size = draw(12);
    smbus.data = pointer();
    return &smbus;
}

#define ERRORS(...)                                                                                          \
    (const int[]) {                                                                                          \
        __VA_ARGS__, 0                                                                                       \
    }
static void judge(const char* what, long result, const int* allowed) {
    const int error = errno;
    if (result >= 0) return;
    for (; *allowed != 0; allowed++)
        if (*allowed == error) return;
    wrong++;
    printf("%s: %ld %s\n", what, result, strerror(error));
}

#define CALL(call, ...)                                                                                      \
    do {                                                                                                     \
        errno = 0;                                                                                           \
        judge(#call, (long)(call), ERRORS(__VA_ARGS__));                                                     \
    } while (0)

static void one_call(void) {
    static const char* const paths[] = {"/dev/ttyS0", "/dev/i2c-3", "/dev/./ttyS0",
                                        "/dev/fd/3",  "/nowhere",   ""};
    const char* path = draw(3) ? paths[draw(6)] : pointer();
    const int fd = some_fd();
    const unsigned long number = request();
    struct timespec soon = {0, (long)draw(1000000)};
    struct iovec parts[4];
    for (int i = 0; i < 4; i++)
        parts[i] = (struct iovec){pointer(), draw(4) ? draw(50) : size()};
    switch (draw(34)) {
    case 0:
    case 1:
        CALL(read(fd, pointer(), size()), EAGAIN, EFAULT, EBADF, EINVAL, EREMOTEIO, ETIMEDOUT, EOPNOTSUPP);
        break;
    case 2:
    case 3:
        CALL(write(fd, pointer(), draw(3) ? draw(100) : size()), EAGAIN, EFAULT, EBADF, EINVAL, EREMOTEIO,
             ETIMEDOUT, EOPNOTSUPP);
        break;
    case 4:
    case 5:
    case 6:
    case 7:
        CALL(ioctl(fd, number, number == I2C_RDWR || number == I2C_SMBUS ? i2c_argument(number) : pointer()),
             EFAULT, EBADF, EINVAL, ENOTTY, EREMOTEIO, ETIMEDOUT, EOPNOTSUPP, EBADMSG, EPROTO);
        break;
    case 8:
        CALL(lseek(fd, (long)draw(100) - 50, (int)draw(6)), EBADF, ESPIPE, EINVAL);
        break;
    case 9:
        CALL(pread(fd, pointer(), size(), draw(9)), EBADF, ESPIPE, EINVAL, EFAULT, EREMOTEIO, ETIMEDOUT,
             EAGAIN);
        break;
    case 10:
        CALL(pwrite(fd, pointer(), draw(100), draw(9)), EBADF, ESPIPE, EINVAL, EFAULT, EREMOTEIO, ETIMEDOUT);
        break;
    case 11:
        CALL(fstat(fd, draw(2) ? (void*)pages : (void*)(pages + 8192)), EBADF, EFAULT);
        break;
    case 12:
        CALL(stat(path, draw(2) ? (void*)pages : (void*)pages), EFAULT, ENOENT, ENAMETOOLONG);
        break;
    case 13: {
        static const int flags[] = {
            O_RDONLY,        O_WRONLY, O_RDWR,   O_RDWR | O_NONBLOCK, O_RDWR | O_DIRECTORY,
            O_RDWR | O_EXCL, O_PATH,   O_ACCMODE};
        errno = 0;
        const int made = open(path, flags[draw(8)]);
        judge("open", made, ERRORS(EFAULT, ENOENT, ENOTDIR, EEXIST, EINVAL, EBADF, ENAMETOOLONG, ENXIO));
        if (made >= 0) close(made);
        break;
    }
    case 14:
        CALL(access(path, (int)draw(8)), EFAULT, ENOENT, EACCES, EINVAL, ENAMETOOLONG);
        break;
    case 15:
        CALL(readv(fd, parts, (int)draw(5)), EAGAIN, EFAULT, EBADF, EINVAL, EREMOTEIO, ETIMEDOUT, EOPNOTSUPP);
        break;
    case 16:
        CALL(writev(fd, parts, (int)draw(5)), EAGAIN, EFAULT, EBADF, EINVAL, EREMOTEIO, ETIMEDOUT,
             EOPNOTSUPP);
        break;
    case 17:
        CALL(readv(fd, pointer(), (int)draw(3000) - 10), EAGAIN, EFAULT, EBADF, EINVAL, EREMOTEIO, ETIMEDOUT,
             EOPNOTSUPP);
        break;
    case 18:
        CALL(poll(pointer(), draw(3) ? draw(20) : draw(70000), 1), EFAULT, EINVAL);
        break;
    case 19:
        CALL(select((int)draw(1100) - 20, pointer(), pointer(), NULL, &(struct timeval){0, 100}), EFAULT,
             EINVAL, EBADF);
        break;
    case 20:
        CALL(fcntl(fd, F_SETFL, O_NONBLOCK | (draw(2) ? O_APPEND : 0)), EBADF, EINVAL);
        break;
    case 21:
        CALL(fcntl(fd, F_GETLK, pointer()), EBADF, EFAULT, EINVAL, EOVERFLOW);
        break;
    case 22:
        CALL(clock_gettime((int)draw(20) - 4, pointer()), EFAULT, EINVAL);
        break;
    case 23:
        CALL(nanosleep(draw(2) ? &soon : (void*)(pages + 8192), NULL), EFAULT, EINVAL);
        break;
    case 24:
        CALL(gettimeofday(pointer(), NULL), EFAULT);
        break;
    case 25:
        CALL(getrusage((int)draw(5) - 2, pointer()), EFAULT, EINVAL);
        break;
    case 26:
        CALL(times(pointer()), EFAULT);
        break;
    case 27:
        CALL(mmap(NULL, 1 + draw(9000), PROT_READ, MAP_SHARED, fd, 0), EBADF, ENODEV, EACCES, EINVAL);
        break;
    case 28:
        CALL(syscall(draw(2) ? SYS_read : SYS_write, fd, pointer(), (size_t)draw(300)), EAGAIN, EFAULT, EBADF,
             EINVAL, EREMOTEIO, ETIMEDOUT);
        break;
    case 29:
        CALL(syscall(SYS_ioctl, fd, number, pointer()), EFAULT, EBADF, EINVAL, ENOTTY, EREMOTEIO, ETIMEDOUT,
             EOPNOTSUPP, EBADMSG, EPROTO);
        break;
    case 30:
        CALL(sendfile(fd, some_fd(), NULL, 10), EINVAL, EBADF, EAGAIN);
        break;
    case 31: {
        errno = 0;
        const int made = draw(2) ? dup(fd) : fcntl(fd, F_DUPFD, 50);
        judge("dup", made, ERRORS(EBADF));
        if (made >= 0) CALL(close(made), EBADF);
        break;
    }
    case 32:
        CALL(tcflush(fd, (int)draw(5)), EBADF, EINVAL, ENOTTY);
        break;
    default:
        CALL(getrandom(pointer(), draw(600), 0), EFAULT);
        break;
    }
    /* what makes calls wait, or the adapter answer otherwise, is set back */
    fcntl(fds[0], F_SETFL, O_NONBLOCK);
    fcntl(fds[2], F_SETFL, O_NONBLOCK);
    fcntl(fds[3], F_SETFL, O_NONBLOCK);
    fcntl(fds[7], F_SETFL, O_NONBLOCK);
    ioctl(fds[1], I2C_TENBIT, 0);
    ioctl(fds[1], I2C_TIMEOUT, 1L);
    ioctl(fds[0], TCXONC, TCOON);
    tcsetattr(fds[0], TCSANOW, &usual);
    if (draw(4) == 0) tcflush(fds[0], TCIOFLUSH);
}

int main(int argc, char** argv) {
    (void)argc;
    state = strtoull(argv[1], NULL, 10) * 2654435761u + 1;
    const long calls = atol(argv[2]);
    struct stat before, after;
    if (stat("/dev/null", &before) != 0) return 3;
    pages = mmap(NULL, 3 * 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    mprotect(pages + 4096, 4096, PROT_READ);
    munmap(pages + 8192, 4096);
    fds[0] = open_serial(1, 0);
    tcgetattr(fds[0], &usual);
    fds[1] = open("/dev/i2c-3", O_RDWR);
    int pipes[2];
    if (pipe2(pipes, O_NONBLOCK) != 0) return 3;
    fds[2] = pipes[0];
    fds[3] = pipes[1];
    fds[4] = open("/dev/null", O_RDWR);
    fds[5] = fds[0];
    fds[6] = fds[1];
    fds[7] = open("/dev/video1", O_RDWR | O_NONBLOCK);
    fd_count = 8;
    fcntl(fds[0], F_SETFL, O_NONBLOCK);
    ioctl(fds[1], I2C_SLAVE, 0x60);
    for (long i = 0; i < calls; i++)
        one_call();
    if (stat("/dev/null", &after) != 0 || after.st_mode != before.st_mode ||
        after.st_rdev != before.st_rdev) {
        wrong++;
        printf("the host's file has changed\n");
    }
    printf("%ld calls, %ld wrong\n", calls, wrong);
    return wrong != 0;
}
