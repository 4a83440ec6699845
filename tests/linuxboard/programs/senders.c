/* Whose number a program finds where the kernel states one: who sent a signal that came by a descriptor, or that
   was blocked when it came; who holds a lock, is at the other end of a socket, was last at a queue. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ipc.h>
#include <sys/msg.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

static pid_t child;

static const char *who(pid_t process) {
    static char number[2][16];
    static int next;
    next = !next;
    if (process == getpid()) return "self";
    if (process == child) return "child";
    sprintf(number[next], "%d", (int)process);
    return number[next];
}

/* A child that sends `number` after 10 ms and ends with `status`. */
static void make_child(int number, int status) {
    child = fork();
    if (child != 0) return;
    usleep(10000);
    kill(getppid(), number);
    usleep(10000);
    _exit(status);
}

static void show(const char *way, const struct signalfd_siginfo *info) {
    printf("%s: signal %u by %s, user %d, code %d, status %d\n", way, info->ssi_signo,
           who((pid_t)info->ssi_pid), info->ssi_uid == getuid(), info->ssi_code,
           info->ssi_signo == SIGCHLD ? info->ssi_status : 0);
}

static void by_descriptor(void) {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGUSR1);
    sigaddset(&set, SIGCHLD);
    sigprocmask(SIG_BLOCK, &set, NULL);
    const int fd = signalfd(-1, &set, SFD_CLOEXEC);
    struct signalfd_siginfo info[2];
    make_child(SIGUSR1, 5);
    if (read(fd, info, sizeof info[0]) == (ssize_t)sizeof info[0]) show("read", info);
    struct iovec part = {info, sizeof info[0]};
    if (readv(fd, &part, 1) == (ssize_t)sizeof info[0]) show("readv", info);
    wait(NULL);
    raise(SIGUSR1);
    if (read(fd, info, sizeof info) == (ssize_t)sizeof info[0]) show("raised", info);
    make_child(SIGUSR1, 6);
    usleep(50000); /* both are there: two records at once, the lower number first */
    if (read(dup(fd), info, sizeof info) == (ssize_t)sizeof info) show("first", &info[0]), show("second", &info[1]);
    wait(NULL);
    sigprocmask(SIG_UNBLOCK, &set, NULL);
    close(fd);
}

static void on_signal(int number, siginfo_t *info, void *context) {
    (void)context;
    printf("unblocked: signal %d by %s\n", number, who(info->si_pid));
}

static void kept(void) {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGUSR2);
    struct sigaction action = {.sa_sigaction = on_signal, .sa_flags = SA_SIGINFO};
    sigaction(SIGUSR2, &action, NULL);
    sigprocmask(SIG_BLOCK, &set, NULL);
    make_child(SIGUSR2, 0);
    wait(NULL);
    sigprocmask(SIG_UNBLOCK, &set, NULL);
    sigprocmask(SIG_BLOCK, &set, NULL);
    make_child(SIGUSR2, 0);
    wait(NULL);
    siginfo_t info;
    int number = sigwaitinfo(&set, &info);
    printf("waited for: signal %d by %s\n", number, who(info.si_pid));
    raise(SIGUSR2);
    number = sigwaitinfo(&set, &info);
    printf("waited for: signal %d by %s\n", number, who(info.si_pid));
}

static void send_credentials(int fd) {
    union {
        char room[CMSG_SPACE(sizeof(struct ucred))];
        struct cmsghdr head;
    } control;
    memset(&control, 0, sizeof control);
    const struct ucred own = {getpid(), getuid(), getgid()};
    struct iovec part = {"x", 1};
    struct msghdr message = {.msg_iov = &part,
                             .msg_iovlen = 1,
                             .msg_control = &control,
                             .msg_controllen = sizeof control.room};
    control.head.cmsg_level = SOL_SOCKET;
    control.head.cmsg_type = SCM_CREDENTIALS;
    control.head.cmsg_len = CMSG_LEN(sizeof own);
    memcpy(CMSG_DATA(&control.head), &own, sizeof own);
    if (sendmsg(fd, &message, 0) != 1) printf("sendmsg: %s\n", strerror(errno));
}

static void sockets(void) {
    int ends[2];
    const int on = 1;
    struct ucred peer;
    socklen_t size = sizeof peer;
    socketpair(AF_UNIX, SOCK_DGRAM, 0, ends);
    setsockopt(ends[0], SOL_SOCKET, SO_PASSCRED, &on, sizeof on);
    if (getsockopt(ends[0], SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0) printf("peer: %s\n", who(peer.pid));
    child = fork();
    if (child == 0) {
        send_credentials(ends[1]);
        _exit(0);
    }
    char byte, control[256];
    struct iovec part = {&byte, 1};
    struct msghdr message = {
        .msg_iov = &part, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof control};
    if (recvmsg(ends[0], &message, 0) != 1) printf("recvmsg: %s\n", strerror(errno));
    for (struct cmsghdr *head = CMSG_FIRSTHDR(&message); head != NULL; head = CMSG_NXTHDR(&message, head)) {
        struct ucred sender;
        memcpy(&sender, CMSG_DATA(head), sizeof sender);
        if (head->cmsg_type == SCM_CREDENTIALS) printf("sender: %s\n", who(sender.pid));
    }
    wait(NULL);
}

static void shared(void) {
    const int queue = msgget(IPC_PRIVATE, 0600), set = semget(IPC_PRIVATE, 1, 0600);
    const int memory = shmget(IPC_PRIVATE, 4096, 0600);
    char name[] = "/tmp/puckloop-senders-XXXXXX";
    const int file = mkstemp(name);
    unlink(name);
    child = fork();
    if (child == 0) {
        const struct {
            long kind;
            char text[4];
        } message = {1, "abc"};
        struct sembuf up = {0, 1, 0};
        struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
        void *place = shmat(memory, NULL, 0);
        if (msgsnd(queue, &message, 4, 0) != 0 || semop(set, &up, 1) != 0 || place == (void *)-1) _exit(1);
        if (fcntl(file, F_SETLK, &lock) != 0) _exit(2);
        usleep(50000);
        _exit(0);
    }
    usleep(20000);
    struct msqid_ds messages;
    struct shmid_ds memories;
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    msgctl(queue, IPC_STAT, &messages);
    shmctl(memory, IPC_STAT, &memories);
    fcntl(file, F_GETLK, &lock);
    printf("message by %s, semaphore by %s", who(messages.msg_lspid), who(semctl(set, 0, GETPID)));
    printf(", memory of %s, used by %s", who(memories.shm_cpid), who(memories.shm_lpid));
    printf(", lock of %s\n", who(lock.l_pid));
    msgctl(queue, IPC_RMID, NULL);
    semctl(set, 0, IPC_RMID);
    shmctl(memory, IPC_RMID, NULL);
    wait(NULL);
}

int main(void) {
    setvbuf(stdout, NULL, _IOLBF, 0);
    by_descriptor();
    kept();
    sockets();
    shared();
    return 0;
}
