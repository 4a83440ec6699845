/* A chat as of a textbook: select(), lines of a stream over the socket, names, half-close, a guest that is thrown
   out. Arguments: server | guest NAME HOST LINE... */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

enum { kPort = 7500, kMost = 16 };

struct guest {
    int socket;
    char name[32], buffer[512];
    size_t filled;
    int done; /* it has closed its half */
};
static struct guest guests[kMost];

static void pause_ms(long ms) {
    struct timespec time = {ms / 1000, ms % 1000 * 1000000};
    nanosleep(&time, NULL);
}

static void leave(struct guest* guest, const char* how) {
    printf("%s leaves: %s\n", guest->name, how);
    fflush(stdout);
    close(guest->socket);
    guest->socket = -1;
}

static void to_others(const struct guest* from, const char* line) {
    for (struct guest* to = guests; to < guests + kMost; ++to) {
        if (to->socket < 0 || to == from || to->name[0] == 0) continue;
        struct iovec parts[3] = {{(char*)from->name, strlen(from->name)}, {": ", 2}, {(char*)line, strlen(line)}};
        if (writev(to->socket, parts, 3) < 0) printf("to %s: %s\n", to->name, strerror(errno));
    }
}

static void heard(struct guest* guest, char* line) {
    if (guest->name[0] == 0) {
        snprintf(guest->name, sizeof guest->name, "%.*s", (int)strcspn(line, "\r\n"), line);
        printf("%s comes\n", guest->name);
    } else if (strncmp(line, "/throw ", 7) == 0) {
        line[strcspn(line, "\r\n")] = 0;
        for (struct guest* out = guests; out < guests + kMost; ++out)
            if (out->socket >= 0 && strcmp(out->name, line + 7) == 0) {
                struct linger hard = {1, 0};
                setsockopt(out->socket, SOL_SOCKET, SO_LINGER, &hard, sizeof hard);
                leave(out, "thrown out");
            }
    } else {
        to_others(guest, line);
    }
    fflush(stdout);
}

static void read_guest(struct guest* guest) {
    int waiting = 0;
    ioctl(guest->socket, FIONREAD, &waiting);
    ssize_t got = recv(guest->socket, guest->buffer + guest->filled, sizeof guest->buffer - 1 - guest->filled, 0);
    if (got > 0 && waiting < got) printf("more than FIONREAD had\n");
    if (got < 0) {
        leave(guest, strerror(errno));
        return;
    }
    if (got == 0) { /* it hears on: what others say goes to it for a while */
        guest->done = 1;
        printf("%s has said all\n", guest->name);
        fflush(stdout);
        return;
    }
    guest->filled += (size_t)got;
    guest->buffer[guest->filled] = 0;
    char* end;
    while ((end = strchr(guest->buffer, '\n')) != NULL) {
        char line[512];
        size_t length = (size_t)(end - guest->buffer) + 1;
        memcpy(line, guest->buffer, length);
        line[length] = 0;
        memmove(guest->buffer, end + 1, guest->filled - length + 1);
        guest->filled -= length;
        heard(guest, line);
        if (guest->socket < 0) return;
    }
}

static int serve(void) {
    signal(SIGPIPE, SIG_IGN);
    int listener = socket(AF_INET, SOCK_STREAM, 0), on = 1;
    setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    struct sockaddr_in place = {.sin_family = AF_INET, .sin_port = htons(kPort)};
    if (bind(listener, (struct sockaddr*)&place, sizeof place) != 0 || listen(listener, 4) != 0) return 1;
    for (int i = 0; i < kMost; ++i) guests[i].socket = -1;
    int quiet = 0;
    while (quiet < 15) {
        fd_set readable;
        FD_ZERO(&readable);
        FD_SET(listener, &readable);
        int highest = listener, open = 0;
        for (int i = 0; i < kMost; ++i)
            if (guests[i].socket >= 0) {
                ++open;
                if (guests[i].done) continue;
                FD_SET(guests[i].socket, &readable);
                if (guests[i].socket > highest) highest = guests[i].socket;
            }
        struct timeval patience = {0, 100000};
        int ready = select(highest + 1, &readable, NULL, NULL, &patience);
        if (ready < 0) return 2;
        quiet = ready == 0 ? quiet + 1 : 0;
        if (ready == 0 && (patience.tv_sec != 0 || patience.tv_usec != 0)) printf("time left\n");
        if (FD_ISSET(listener, &readable)) {
            struct sockaddr_in from;
            socklen_t length = sizeof from;
            int taken = accept(listener, (struct sockaddr*)&from, &length);
            if (length != sizeof from || from.sin_family != AF_INET) printf("odd address\n");
            for (int i = 0; i < kMost; ++i)
                if (guests[i].socket < 0) {
                    memset(&guests[i], 0, sizeof guests[i]);
                    guests[i].socket = taken;
                    break;
                }
        }
        for (int i = 0; i < kMost; ++i)
            if (guests[i].socket >= 0 && !guests[i].done && FD_ISSET(guests[i].socket, &readable)) read_guest(&guests[i]);
    }
    to_others(&guests[kMost - 1], "closing time\n");
    for (int i = 0; i < kMost; ++i)
        if (guests[i].socket >= 0) {
            shutdown(guests[i].socket, SHUT_WR);
            leave(&guests[i], "at the end");
        }
    return 0;
}

static int connect_to(const char* host) {
    struct hostent* found = gethostbyname(host);
    if (found == NULL) {
        herror(host);
        return -1;
    }
    struct sockaddr_in place = {.sin_family = AF_INET, .sin_port = htons(kPort)};
    memcpy(&place.sin_addr, found->h_addr_list[0], sizeof place.sin_addr);
    for (int attempt = 0; attempt < 50; ++attempt) {
        int one = socket(AF_INET, SOCK_STREAM, 0);
        fcntl(one, F_SETFL, fcntl(one, F_GETFL) | O_NONBLOCK);
        if (connect(one, (struct sockaddr*)&place, sizeof place) != 0 && errno != EINPROGRESS) return -1;
        fd_set writable;
        FD_ZERO(&writable);
        FD_SET(one, &writable);
        struct timeval patience = {2, 0};
        int error = 0;
        socklen_t length = sizeof error;
        if (select(one + 1, NULL, &writable, NULL, &patience) == 1 &&
            getsockopt(one, SOL_SOCKET, SO_ERROR, &error, &length) == 0 && error == 0) {
            fcntl(one, F_SETFL, fcntl(one, F_GETFL) & ~O_NONBLOCK);
            return one;
        }
        close(one);
        pause_ms(100);
    }
    return -1;
}

static void broken(int number) {
    static const char kWord[] = "broken pipe\n";
    _exit(number == SIGPIPE && write(1, kWord, sizeof kWord - 1) > 0 ? 0 : 3);
}

int main(int count, char** words) {
    if (count < 2) return 2;
    if (strcmp(words[1], "server") == 0) return serve();
    signal(SIGPIPE, broken);
    int one = connect_to(words[3]);
    if (one < 0) return 1;
    FILE* out = fdopen(dup(one), "w"); /* a stream of its own each way */
    FILE* in = fdopen(one, "r");
    setvbuf(out, NULL, _IOLBF, 0);
    fprintf(out, "%s\n", words[2]);
    for (int i = 4; i < count; ++i) {
        pause_ms(atoi(words[i]));
        fprintf(out, "%s\n", strchr(words[i], ' ') + 1);
    }
    fflush(out);
    shutdown(fileno(out), SHUT_WR);
    fclose(out);
    char line[512];
    while (fgets(line, sizeof line, in) != NULL) {
        printf("%s", line);
        fflush(stdout);
    }
    printf("%s\n", ferror(in) ? strerror(errno) : "end");
    fclose(in);
    return 0;
}
