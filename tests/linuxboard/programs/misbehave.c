/* Ends badly in the way its argument names. */
#include "serial.h"
#include <signal.h>
#include <sys/ioctl.h>

static volatile sig_atomic_t signalled;
static void handler(int number) {
    signalled = number;
}

int main(int argc, char** argv) {
    const char* how = argc > 1 ? argv[1] : "";
    if (strcmp(how, "never-opens") == 0) return 0;
    int fd = open_serial(1, 0);
    usleep(5000);
    if (strcmp(how, "crash") == 0) {
        fprintf(stderr, "about to follow a null pointer\n");
        *(volatile int*)NULL = 1;
    }
    if (strcmp(how, "fail") == 0) {
        fprintf(stderr, "no robot here\n");
        return 7;
    }
    if (strcmp(how, "spin") == 0) {
        for (volatile int i = 0;; i++) {
        }
    }
    if (strcmp(how, "poll") == 0) {
        /* a polling loop: lets time pass by what each call costs */
        char b;
        fcntl(fd, F_SETFL, O_NONBLOCK);
        long polls = 0;
        while (read(fd, &b, 1) != 1)
            polls++;
        printf("%ld polls, then %c\n", polls, b);
        return 0;
    }
    if (strcmp(how, "signal") == 0) {
        char b = 0;
        signal(SIGUSR1, SIG_IGN);
        signal(SIGINT, handler);
        long n = read(fd, &b, 1); /* signal(): SA_RESTART */
        printf("read %ld after signal %d\n", n, (int)signalled);
        struct sigaction action;
        memset(&action, 0, sizeof action);
        action.sa_handler = handler;
        sigaction(SIGTERM, &action, NULL);
        n = read(fd, &b, 1);
        printf("read %ld after signal %d\n", n, (int)signalled);
        return 0;
    }
    if (strcmp(how, "odd-ioctl") == 0) {
        char serial[512];
        printf("%d\n", ioctl(fd, 0x5470, serial));
        return 0;
    }
    return 1;
}
