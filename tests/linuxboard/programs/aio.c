/* POSIX asynchronous reads and writes of a pipe, the serial port and a file. Times in milliseconds. */
#define _GNU_SOURCE
#include "serial.h"
#include <aio.h>
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <time.h>

static long ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (t.tv_sec - 60) * 1000L + t.tv_nsec / 1000000L;
}

static void check(int ok, const char* what) {
    if (ok) return;
    printf("%s: %s at %ld\n", what, strerror(errno), ms());
    exit(9);
}

static int ends[2];
static void* write_later(void* text) {
    usleep(30000);
    check(write(ends[1], text, 3) == 3, "write");
    return NULL;
}

static volatile sig_atomic_t got;
static void on_signal(int number, siginfo_t* info, void* context) {
    (void)number;
    (void)context;
    got = info->si_value.sival_int;
}

static struct aiocb block(int fd, void* buffer, size_t size) {
    struct aiocb b;
    memset(&b, 0, sizeof b);
    b.aio_fildes = fd;
    b.aio_buf = buffer;
    b.aio_nbytes = size;
    b.aio_sigevent.sigev_notify = SIGEV_NONE;
    return b;
}

static void wait_for(const struct aiocb* b) {
    while (aio_error(b) == EINPROGRESS)
        check(aio_suspend(&b, 1, NULL) == 0 || errno == EINTR, "aio_suspend");
}

int main(void) {
    char text[8] = "";
    setvbuf(stdout, NULL, _IOLBF, 0);
    int port = open_serial(1, 0);
    check(pipe(ends) == 0, "pipe");
    struct aiocb in = block(ends[0], text, 3);
    const struct aiocb* list[] = {NULL, &in};
    check(aio_read(&in) == 0 && aio_error(&in) == EINPROGRESS, "aio_read");
    const struct timespec little = {0, 10000000};
    check(aio_suspend(list, 2, &little) == -1 && errno == EAGAIN, "a limit");
    printf("limit at %ld, cancel %d %d\n", ms(), aio_cancel(ends[0], &in) == AIO_NOTCANCELED,
           aio_cancel(ends[1], NULL) == AIO_ALLDONE);
    pthread_t thread;
    pthread_create(&thread, NULL, write_later, "abc");
    wait_for(&in);
    printf("pipe %zd %s at %ld\n", aio_return(&in), text, ms());
    pthread_join(thread, NULL);

    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_sigaction = on_signal;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGUSR1, &action, NULL);
    struct aiocb out = block(port, "R", 1), answer = block(port, text, 1);
    answer.aio_sigevent.sigev_notify = SIGEV_SIGNAL;
    answer.aio_sigevent.sigev_signo = SIGUSR1;
    answer.aio_sigevent.sigev_value.sival_int = 7;
    check(aio_read(&answer) == 0 && aio_write(&out) == 0, "the port");
    wait_for(&answer);
    wait_for(&out);
    printf("port %zd %zd %c, signal %d, at %ld\n", aio_return(&out), aio_return(&answer), text[0], (int)got,
           ms());

    FILE* file = tmpfile();
    struct aiocb first = block(fileno(file), "first", 5), second = block(fileno(file), "second", 6);
    first.aio_lio_opcode = second.aio_lio_opcode = LIO_WRITE;
    second.aio_offset = 5;
    struct aiocb* both[] = {&first, NULL, &second};
    check(lio_listio(LIO_WAIT, both, 3, NULL) == 0, "lio_listio");
    char back[12] = "";
    check(pread(fileno(file), back, 11, 0) == 11, "pread");
    struct aiocb bad = block(99, text, 1);
    check(aio_read(&bad) == 0, "a bad descriptor");
    wait_for(&bad);
    printf("file %s, bad %d %zd\n", back, aio_error(&bad) == EBADF, aio_return(&bad));
    return 0;
}
