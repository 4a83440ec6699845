/* Ends when it is asked to, in the way its first argument names; a second one is a file that it saves then.
 */
#include "serial.h"
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <time.h>

static volatile sig_atomic_t asked;
static const char* file;

static void handler(int number) {
    asked = number;
}

static long now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (t.tv_sec - 60) * 1000 + t.tv_nsec / 1000000;
}

static void save(void) {
    printf("saved at %ld ms\n", now_ms());
    FILE* out = file != NULL ? fopen(file, "w") : NULL;
    if (out != NULL) {
        fprintf(out, "calibration\n");
        fclose(out);
    }
}

static void* work(void* unused) {
    while (!asked)
        usleep(1000);
    return unused;
}

static void* wait_for_signal(void* set) {
    int number = 0;
    sigwait(set, &number);
    asked = number;
    return NULL;
}

int main(int argc, char** argv) {
    const char* how = argc > 1 ? argv[1] : "";
    file = argc > 2 ? argv[2] : NULL;
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = strcmp(how, "deaf") == 0 ? SIG_IGN : handler;
    action.sa_flags = strcmp(how, "restart") == 0 ? SA_RESTART : 0;
    if (strcmp(how, "plain") != 0) {
        sigaction(SIGINT, &action, NULL);
        sigaction(SIGTERM, &action, NULL);
    }
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    if (strcmp(how, "sigwait") == 0) sigprocmask(SIG_BLOCK, &set, NULL);
    int fd = open_serial(1, 0);
    atexit(save);
    pthread_t thread;
    char byte = 0;
    long got = -1;
    if (strcmp(how, "threads") == 0) {
        pthread_create(&thread, NULL, work, NULL);
        pthread_join(thread, NULL);
    } else if (strcmp(how, "sigwait") == 0) {
        pthread_create(&thread, NULL, wait_for_signal, &set);
        pthread_join(thread, NULL);
    } else {
        errno = 0;
        got = read(fd, &byte, 1);
        printf("read %ld, %s, signal %d\n", got, got < 0 ? strerror(errno) : "a byte", (int)asked);
    }
    if (strcmp(how, "crash") == 0) *(volatile int*)NULL = 1;
    printf("asked by %d at %ld ms\n", (int)asked, now_ms());
    if (write(fd, "R", 1) != 1) return 4;
    return strcmp(how, "fail") == 0 ? 9 : 0;
}
