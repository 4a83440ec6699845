/* Objects that processes share: a barrier, a condition, a semaphore, and what happens when. Times in
 * milliseconds. */
#define _GNU_SOURCE
#include "serial.h"
#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>

struct shared {
    pthread_barrier_t barrier;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    sem_t ready;
    int serial, value, waits;
};

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

static struct shared* make(void* memory, unsigned count) {
    struct shared* s = memory;
    pthread_barrierattr_t barrier;
    pthread_mutexattr_t mutex;
    pthread_condattr_t condition;
    pthread_barrierattr_init(&barrier);
    pthread_mutexattr_init(&mutex);
    pthread_condattr_init(&condition);
    pthread_barrierattr_setpshared(&barrier, PTHREAD_PROCESS_SHARED);
    pthread_mutexattr_setpshared(&mutex, PTHREAD_PROCESS_SHARED);
    pthread_condattr_setpshared(&condition, PTHREAD_PROCESS_SHARED);
    pthread_condattr_setclock(&condition, CLOCK_MONOTONIC);
    check(pthread_barrier_init(&s->barrier, &barrier, count) == 0, "barrier");
    check(pthread_mutex_init(&s->mutex, &mutex) == 0, "mutex");
    check(pthread_cond_init(&s->changed, &condition) == 0, "condition");
    check(sem_init(&s->ready, 1, 0) == 0, "semaphore");
    return s;
}

static void meet(struct shared* s) {
    if (pthread_barrier_wait(&s->barrier) == PTHREAD_BARRIER_SERIAL_THREAD)
        __sync_fetch_and_add(&s->serial, 1);
}

static void wait_all(void) {
    int status;
    while (wait(&status) > 0)
        check(WIFEXITED(status) && WEXITSTATUS(status) == 0, "a child");
}

static void barriers(struct shared* s) {
    for (int child = 1; child <= 2; child++) {
        if (fork() != 0) continue;
        for (int round = 0; round < 3; round++) {
            usleep((useconds_t)child * 20000);
            meet(s);
        }
        exit(0);
    }
    for (int round = 0; round < 3; round++) {
        meet(s);
        printf("round %d at %ld\n", round, ms());
    }
    wait_all();
    printf("serial %d\n", s->serial);
    check(pthread_barrier_destroy(&s->barrier) == 0, "destroy");
}

static void conditions(struct shared* s) {
    if (fork() == 0) {
        usleep(50000);
        pthread_mutex_lock(&s->mutex);
        s->value = 7;
        pthread_cond_signal(&s->changed);
        pthread_mutex_unlock(&s->mutex);
        sem_wait(&s->ready);
        printf("semaphore at %ld\n", ms());
        exit(0);
    }
    pthread_mutex_lock(&s->mutex);
    while (s->value == 0) {
        pthread_cond_wait(&s->changed, &s->mutex);
        s->waits++;
    }
    printf("value %d after %d wait, at %ld\n", s->value, s->waits, ms());
    struct timespec limit;
    clock_gettime(CLOCK_MONOTONIC, &limit);
    limit.tv_nsec += 30000000;
    check(pthread_cond_timedwait(&s->changed, &s->mutex, &limit) == ETIMEDOUT, "timed wait");
    printf("too late at %ld\n", ms());
    pthread_mutex_unlock(&s->mutex);
    sem_post(&s->ready);
    fflush(stdout);
    wait_all();
    check(pthread_cond_destroy(&s->changed) == 0, "destroy");
}

int main(int argc, char** argv) {
    const char* what = argc > 1 ? argv[1] : "";
    setvbuf(stdout, NULL, _IOLBF, 0);
    if (strcmp(what, "second") == 0) { /* a program that has the objects from another one's file */
        int fd = shm_open(argv[2], O_RDWR, 0);
        struct shared* s = mmap(NULL, sizeof *s, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
        check(fd >= 0 && s != MAP_FAILED, "second");
        usleep(30000);
        meet(s);
        return 0;
    }
    open_serial(1, 0);
    struct shared* s = mmap(NULL, sizeof *s, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    check(s != MAP_FAILED, "mmap");
    if (strcmp(what, "barrier") == 0) barriers(make(s, 3));
    if (strcmp(what, "condition") == 0) conditions(make(s, 2));
    if (strcmp(what, "file") == 0) {
        char name[40];
        snprintf(name, sizeof name, "/puckloop-%s", argv[2]);
        int fd = shm_open(name, O_RDWR | O_CREAT | O_EXCL, 0600);
        check(fd >= 0 && ftruncate(fd, sizeof *s) == 0, "shm_open");
        s = make(mmap(NULL, sizeof *s, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0), 2);
        if (fork() == 0) {
            execl(argv[0], argv[0], "second", name, NULL);
            _exit(8);
        }
        meet(s);
        printf("met at %ld\n", ms());
        wait_all();
        shm_unlink(name);
    }
    return 0;
}
