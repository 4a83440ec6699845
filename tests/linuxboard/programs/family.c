/* One use of child processes and of exec for each argument. Times in milliseconds since the start. */
#define _GNU_SOURCE
#include "serial.h"
#include <errno.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <time.h>

extern char** environ;
static char* self;
static const int kBlock = 300000; /* more than a pipe holds */

static long ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (t.tv_sec - 60) * 1000L + t.tv_nsec / 1000000L;
}

static void check(int ok, const char* what) {
    if (ok) return;
    printf("%s: %s\n", what, strerror(errno));
    exit(9);
}

static volatile sig_atomic_t children, terms;
static void count_child(int number) {
    (void)number;
    children++;
}
static void count_term(int number) {
    (void)number;
    terms++;
}

/* Two processes write to the port in turns, each in its own rhythm. */
static void share(void) {
    int fd = open_serial(1, 0);
    pid_t child = fork();
    check(child >= 0, "fork");
    for (int i = 0; i < 4; i++) {
        usleep(child == 0 ? 30000 : 20000);
        char byte = (char)((child == 0 ? 'a' : 'A') + i);
        check(write(fd, &byte, 1) == 1, "write");
    }
    if (child == 0) exit(3);
    int status = 0;
    check(waitpid(child, &status, 0) == child, "waitpid");
    printf("child %d of %d, its parent %d, status %d at %ld\n", (int)child, (int)getpid(), (int)getppid(),
           WEXITSTATUS(status), ms());
}

/* More than a pipe holds, through it and back, with stdio at both ends. */
static void pipes(void) {
    int down[2], up[2];
    check(pipe(down) == 0 && pipe(up) == 0, "pipe");
    pid_t child = fork();
    if (child == 0) {
        close(down[1]);
        close(up[0]);
        dup2(down[0], 0);
        dup2(up[1], 1);
        close(down[0]);
        close(up[1]);
        execl(self, self, "copy", (char*)NULL);
        _exit(8);
    }
    close(down[0]);
    close(up[1]);
    pid_t writer = fork();
    if (writer == 0) {
        close(up[0]);
        char* block = malloc((size_t)kBlock);
        memset(block, 'x', (size_t)kBlock);
        for (int i = 99; i < kBlock; i += 100)
            block[i] = '\n';
        check(write(down[1], block, (size_t)kBlock) == kBlock, "long write");
        _exit(0);
    }
    close(down[1]);
    FILE* in = fdopen(up[0], "r");
    char line[200];
    long bytes = 0;
    while (fgets(line, sizeof line, in) != NULL)
        bytes += (long)strlen(line);
    int status = 0, all = 0;
    while (wait(&status) > 0)
        all += WEXITSTATUS(status);
    printf("%ld bytes came back, statuses %d, no child is left: %d\n", bytes, all, errno == ECHILD);
}

static void signals(void) {
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = count_child;
    sigaction(SIGCHLD, &action, NULL);
    pid_t child = fork();
    if (child == 0) {
        signal(SIGTERM, count_term);
        pause();
        usleep(5000);
        _exit(terms);
    }
    usleep(20000);
    check(waitpid(child, NULL, WNOHANG) == 0, "waitpid");
    check(kill(child, SIGTERM) == 0, "kill");
    check(sleep(1) == 1, "an interrupted sleep"); /* 25 ms of it are over: rounded */
    long when = ms();
    int status = 0;
    check(waitpid(-1, &status, 0) == child, "waitpid");
    printf("SIGCHLD %d at %ld, status %d\n", (int)children, when, WEXITSTATUS(status));
    child = fork();
    if (child == 0)
        for (;;)
            pause();
    usleep(1000);
    kill(child, SIGKILL);
    check(waitpid(child, &status, 0) == child, "waitpid");
    printf("killed by %d, kill again %d\n", WTERMSIG(status), kill(child, 0));
}

static void shells(void) {
    printf("system %d\n", WEXITSTATUS(system("sleep 0.05; exit 4")));
    FILE* from = popen("sleep 0.05; echo one; echo two", "r");
    char line[20];
    while (fgets(line, sizeof line, from) != NULL)
        printf("%ld: %s", ms(), line);
    printf("pclose %d\n", WEXITSTATUS(pclose(from)));
    FILE* to = popen("cat; exit 6", "w");
    fprintf(to, "to the child\n");
    printf("pclose %d at %ld\n", WEXITSTATUS(pclose(to)), ms());
}

static void spawns(void) {
    char* words[] = {(char*)"sh", (char*)"-c", (char*)"sleep 0.03; exit 5", NULL};
    pid_t child = 0;
    check(posix_spawnp(&child, "sh", NULL, NULL, words, environ) == 0, "posix_spawnp");
    int status = 0;
    check(waitpid(child, &status, 0) == child, "waitpid");
    printf("spawned %d, status %d at %ld\n", (int)child, WEXITSTATUS(status), ms());
    printf("nowhere: %s\n", strerror(posix_spawn(&child, "/nowhere", NULL, NULL, words, environ)));
    child = vfork();
    if (child == 0) {
        execl("/nowhere", "nowhere", (char*)NULL);
        _exit(errno == ENOENT ? 7 : 8);
    }
    waitpid(child, &status, 0);
    printf("vfork %d\n", WEXITSTATUS(status));
}

/* What a new process is to do first with its descriptors, devices among them. */
static void spawn_actions(int fd) {
    char* words[] = {(char*)"sh", (char*)"-c", (char*)"printf a; printf b >&7; sleep 0.03; exit 5", NULL};
    posix_spawn_file_actions_t actions;
    pid_t child = 0;
    int status = 0;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/ttyS0", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, fd, 7);
    posix_spawn_file_actions_addclose(&actions, fd);
    posix_spawn_file_actions_addclosefrom_np(&actions, 8);
    posix_spawn_file_actions_addchdir_np(&actions, "/");
    check(posix_spawnp(&child, "sh", &actions, NULL, words, environ) == 0, "posix_spawnp");
    check(waitpid(child, &status, 0) == child, "waitpid");
    printf("spawned %d, status %d at %ld\n", (int)child, WEXITSTATUS(status), ms());
    printf("nowhere: %s\n", strerror(posix_spawn(&child, "/nowhere", &actions, NULL, words, environ)));
    posix_spawn_file_actions_addopen(&actions, 9, "/nowhere/file", O_RDONLY, 0);
    printf("no file: %s\n", strerror(posix_spawnp(&child, "sh", &actions, NULL, words, environ)));
    posix_spawn_file_actions_destroy(&actions);
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addclose(&actions, 99);
    posix_spawn_file_actions_adddup2(&actions, 98, 1);
    printf("not open: %s\n", strerror(posix_spawnp(&child, "sh", &actions, NULL, words, environ)));
    posix_spawn_file_actions_destroy(&actions);
    printf("left: %d\n", (int)waitpid(-1, &status, 0));
}

/* A descriptor of the port and an alarm go through exec; one with FD_CLOEXEC does not. */
static void replace(void) {
    int fd = open_serial(1, 0);
    int other = open("/dev/ttyS0", O_RDWR | O_CLOEXEC);
    char kept[20], closed[20];
    snprintf(kept, sizeof kept, "%d", fd);
    snprintf(closed, sizeof closed, "%d", other);
    usleep(20000);
    alarm(1);
    char* const nothing[] = {NULL};
    char* const words[] = {self, (char*)"replaced", kept, closed, NULL};
    execve(self, words, nothing);
    check(0, "execve");
}
static void replaced(int kept, int closed) {
    struct termios t;
    printf("pid %d at %ld, kept %d, closed %d\n", (int)getpid(), ms(), tcgetattr(kept, &t),
           tcgetattr(closed, &t));
    check(write(kept, "k", 1) == 1, "write");
    signal(SIGALRM, count_term);
    pause();
    printf("alarm at %ld\n", ms());
}

static volatile int asked, ended;
static siginfo_t of_ask, of_end;
static void on_ask(int number, siginfo_t* info, void* context) {
    (void)number;
    (void)context;
    of_ask = *info;
    asked++;
}
static void on_end(int number, siginfo_t* info, void* context) {
    (void)number;
    (void)context;
    of_end = *info;
    ended++;
}

static void install(int number, void (*handler)(int, siginfo_t*, void*)) {
    struct sigaction action, before;
    memset(&action, 0, sizeof action);
    action.sa_sigaction = handler;
    action.sa_flags = SA_SIGINFO | SA_RESTART;
    check(sigaction(number, &action, NULL) == 0, "sigaction");
    check(sigaction(number, NULL, &before) == 0 && before.sa_sigaction == handler, "sigaction before");
}

/* Who sent a signal, by a handler that takes siginfo. */
static void origins(void) {
    install(SIGUSR1, on_ask);
    install(SIGCHLD, on_end);
    pid_t child = fork();
    if (child == 0) {
        usleep(10000);
        kill(getppid(), SIGUSR1);
        usleep(10000);
        _exit(5);
    }
    while (!ended)
        usleep(1000);
    printf("asked %d by child %d, user %d, code %d\n", asked, of_ask.si_pid == child,
           of_ask.si_uid == getuid(), of_ask.si_code == SI_USER);
    printf("ended %d: child %d, user %d, code %d, status %d\n", ended, of_end.si_pid == child,
           of_end.si_uid == getuid(), of_end.si_code == CLD_EXITED, of_end.si_status);
    waitpid(child, NULL, 0);
    child = fork();
    if (child == 0) {
        pause();
        _exit(6);
    }
    raise(SIGUSR1);
    printf("raised: self %d\n", of_ask.si_pid == getpid());
    usleep(1000);
    kill(child, SIGTERM);
    while (ended < 2)
        usleep(1000);
    printf("killed: code %d, status %d\n", of_end.si_code == CLD_KILLED, of_end.si_status);
    waitpid(child, NULL, 0);
}

int main(int argc, char** argv) {
    const char* what = argc > 1 ? argv[1] : "";
    self = argv[0];
    if (strcmp(what, "copy") == 0) {
        int c;
        while ((c = getchar()) != EOF)
            putchar(c);
        return 2;
    }
    if (strcmp(what, "replaced") == 0) {
        replaced(atoi(argv[2]), atoi(argv[3]));
        return 0;
    }
    if (strcmp(what, "replace") == 0) replace();
    int fd = strcmp(what, "share") == 0 ? -1 : open_serial(1, 0);
    if (strcmp(what, "share") == 0) share();
    if (strcmp(what, "pipes") == 0) pipes();
    if (strcmp(what, "signals") == 0) signals();
    if (strcmp(what, "origins") == 0) origins();
    if (strcmp(what, "shells") == 0) shells();
    if (strcmp(what, "spawns") == 0) spawns();
    if (strcmp(what, "spawn-actions") == 0) spawn_actions(fd);
    close(fd);
    return 0;
}
