/* Streams of the C library on the serial port, in the way its argument names. Each sends "hello". */
#define _GNU_SOURCE
#include "serial.h"
#include <err.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/wait.h>

static int as_stdout(void) {
    const int fd = open_serial(1, 0);
    return dup2(fd, 1);
}

int main(int argc, char** argv) {
    const char* how = argc > 1 ? argv[1] : "";
    if (strcmp(how, "dup2") == 0) {
        as_stdout();
        printf("hel%s", "lo");
    } else if (strcmp(how, "puts") == 0) {
        as_stdout();
        puts("hello");
    } else if (strcmp(how, "unlocked") == 0) {
        as_stdout();
        fputs_unlocked("hell", stdout);
        putchar_unlocked('o');
        fflush_unlocked(stdout);
    } else if (strcmp(how, "unbuffered") == 0) {
        setvbuf(stdout, NULL, _IONBF, 0);
        as_stdout();
        fwrite("hello", 1, 5, stdout);
    } else if (strcmp(how, "before") == 0) { /* what is in the buffer goes where the descriptor leads then */
        setvbuf(stdout, NULL, _IOFBF, BUFSIZ);
        printf("hello");
        as_stdout();
    } else if (strcmp(how, "kept") == 0) { /* the stream is known from before */
        FILE* out = stdout;
        as_stdout();
        fprintf(out, "hello");
    } else if (strcmp(how, "freopen") == 0) {
        if (freopen("/dev/ttyS0", "w", stdout) == NULL) return 3;
        printf("hello");
    } else if (strcmp(how, "fdopen") == 0) {
        FILE* out = fdopen(open_serial(1, 0), "r+");
        fputs("hello", out);
        fclose(out);
    } else if (strcmp(how, "fopen") == 0) {
        FILE* out = fopen("/dev/ttyS0", "a");
        fprintf(out, "hello");
        fclose(out);
    } else if (strcmp(how, "dprintf") == 0) {
        dprintf(open_serial(1, 0), "hel%s", "lo");
    } else if (strcmp(how, "path") == 0) { /* by the name of a descriptor, and by other ways to the device */
        as_stdout();
        FILE* out = fopen("/dev/stdout", "w");
        fputs("h", out);
        fclose(out);
        int fd = open("/proc/self/fd/1", O_WRONLY);
        dprintf(fd, "e");
        fd = open("/dev/../dev//ttyS0", O_WRONLY);
        dprintf(fd, "l");
        if (chdir("/dev") != 0) return 3;
        fd = open("ttyS0", O_WRONLY);
        dprintf(fd, "l");
        char link[] = "/tmp/puckloop_link_XXXXXX";
        close(mkstemp(link));
        unlink(link);
        if (symlink("/dev/ttyS0", link) != 0) return 3;
        fd = open(link, O_WRONLY);
        dprintf(fd, "o");
        unlink(link);
    } else if (strcmp(how, "perror") == 0) {
        dup2(open_serial(1, 0), 2);
        errno = ENOENT;
        perror("hello");
        warnx("hello");
    } else if (strcmp(how, "fork") == 0) {
        as_stdout();
        if (fork() == 0) {
            printf("hel");
            exit(0);
        }
        wait(NULL);
        printf("lo");
    } else if (strcmp(how, "exec") == 0) {
        as_stdout();
        execlp("printf", "printf", "hello", (char*)NULL);
    } else if (strcmp(how, "read") == 0) { /* both ways: what comes in as lines goes back */
        const int fd = open_serial(1, 0);
        dup2(fd, 0);
        dup2(fd, 1);
        char* line = NULL;
        size_t room = 0;
        char word[20];
        const int first = getchar();
        if (getline(&line, &room, stdin) < 0 || scanf("%19s", word) != 1) return 3;
        printf("%c%s%s", first, strtok(line, "\n"), word);
    } else if (strcmp(how, "tty") == 0) { /* a stream on a terminal ends its buffer with each line */
        const int fd = open_serial(1, 0);
        FILE* out = fdopen(fd, "w");
        fputs("hello\nworld", out);
        usleep(10000);
        fflush(NULL);
        const int moved = fseek(out, 0, SEEK_CUR);
        fprintf(stderr, "seek %d %d\n", moved, errno);
    } else {
        return 4;
    }
    return 0;
}
