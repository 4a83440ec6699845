/* Two threads hand a turn to and fro through a mutex and a condition variable, a third sleeps and writes, a
   fourth is cancelled in its sleep. Everything goes out of the serial port, so order shows. */
#include "serial.h"
#include <pthread.h>
#include <semaphore.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t changed = PTHREAD_COND_INITIALIZER;
static sem_t done;
static int turn;
static int serial;

static void say(char c) {
    if (write(serial, &c, 1) != 1) exit(4);
}

static void* player(void* argument) {
    int me = *(int*)argument;
    for (int i = 0; i < 20; i++) {
        pthread_mutex_lock(&lock);
        while (turn != me)
            pthread_cond_wait(&changed, &lock);
        usleep(500 + 100 * (unsigned)me);
        say((char)('a' + me));
        turn = 1 - me;
        pthread_cond_broadcast(&changed);
        pthread_mutex_unlock(&lock);
    }
    sem_post(&done);
    return NULL;
}

static void* ticker(void* argument) {
    (void)argument;
    for (int i = 0; i < 10; i++) {
        usleep(1700);
        say('.');
    }
    return NULL;
}

static void cleanup(void* argument) {
    (void)argument;
    say('!');
}

static void* sleeper(void* argument) {
    pthread_cleanup_push(cleanup, NULL);
    while (1)
        usleep(1000000);
    pthread_cleanup_pop(0);
    return argument;
}

int main(void) {
    serial = open_serial(1, 0);
    sem_init(&done, 0, 0);
    int numbers[2] = {0, 1};
    pthread_t players[2], detached, cancelled;
    pthread_create(&cancelled, NULL, sleeper, NULL);
    for (int i = 0; i < 2; i++)
        pthread_create(&players[i], NULL, player, &numbers[i]);
    pthread_create(&detached, NULL, ticker, NULL);
    pthread_detach(detached);
    sem_wait(&done);
    sem_wait(&done);
    for (int i = 0; i < 2; i++)
        pthread_join(players[i], NULL);
    pthread_cancel(cancelled);
    void* result = NULL;
    pthread_join(cancelled, &result);
    say(result == PTHREAD_CANCELED ? 'C' : '?');
    tcdrain(serial);
    return 0;
}
