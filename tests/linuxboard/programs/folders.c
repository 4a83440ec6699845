/* All ways to list a folder find the same: the board's processes in /proc, its devices in /dev. */
#define _GNU_SOURCE
#include <dirent.h>
#include <fcntl.h>
#include <fts.h>
#include <ftw.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* Numbers, and the devices of the scenario that this is run with. */
static int shown(const char *name) {
    return *name != '\0' && (name[strspn(name, "0123456789")] == '\0' || strncmp(name, "i2c-", 4) == 0 ||
                             strncmp(name, "ttyS0", 5) == 0);
}

static int by_name(const struct dirent *entry) {
    return shown(entry->d_name);
}

static void print_sorted(const char *way, char names[][32], int count) {
    qsort(names, (size_t)count, sizeof names[0], (int (*)(const void *, const void *))strcmp);
    printf("%s:", way);
    for (int i = 0; i < count; ++i)
        printf(" %s", names[i]);
    printf("\n");
}

static char names[256][32];
static int names_count;
static void add(const char *name) {
    if (shown(name) && names_count < 256) snprintf(names[names_count++], sizeof names[0], "%.31s", name);
}
static void print(const char *way) {
    print_sorted(way, names, names_count);
    names_count = 0;
}

static void by_readdir(const char *path) {
    DIR *folder = opendir(path);
    for (struct dirent *entry; (entry = readdir(folder)) != NULL;)
        add(entry->d_name);
    print("readdir");
    rewinddir(folder);
    long before = -1;
    char last[32] = "";
    for (struct dirent *entry;;) {
        const long here = telldir(folder);
        if ((entry = readdir(folder)) == NULL) break;
        add(entry->d_name);
        before = here;
        snprintf(last, sizeof last, "%.31s", entry->d_name);
    }
    print("rewinddir");
    seekdir(folder, before);
    const struct dirent *again = readdir(folder);
    printf("seekdir: %d\n", again != NULL && strcmp(again->d_name, last) == 0);
    closedir(folder);
}

static void by_scandir(const char *path) {
    struct dirent **list;
    const int count = scandir(path, &list, by_name, alphasort);
    for (int i = 0; i < count; ++i)
        add(list[i]->d_name);
    print("scandir");
}

static void by_glob(const char *pattern) {
    glob_t found = {0};
    if (glob(pattern, 0, NULL, &found) != 0) printf("nothing\n");
    for (size_t i = 0; i < found.gl_pathc; ++i)
        add(strrchr(found.gl_pathv[i], '/') + 1);
    globfree(&found);
    print("glob");
}

static int visit(const char *path, const struct stat *status, int kind, struct FTW *where) {
    (void)status;
    if (where->level == 1 && kind != FTW_NS) add(path + where->base);
    return where->level == 0 ? FTW_CONTINUE : FTW_SKIP_SUBTREE;
}

static void by_nftw(const char *path) {
    nftw(path, visit, 8, FTW_PHYS | FTW_ACTIONRETVAL);
    print("nftw");
}

static void by_fts(char *path) {
    char *const paths[] = {path, NULL};
    FTS *tree = fts_open(paths, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
    for (FTSENT *entry; (entry = fts_read(tree)) != NULL;) {
        if (entry->fts_level != 1 || entry->fts_info == FTS_DP) continue;
        fts_set(tree, entry, FTS_SKIP);
        if (entry->fts_info != FTS_NS) add(entry->fts_name);
    }
    fts_close(tree);
    print("fts_read");
}

struct older {
    unsigned long number;
    long place;
    unsigned short length;
    char name[];
};

static void by_calls(const char *path) {
    const int fd = open(path, O_RDONLY | O_DIRECTORY);
    char list[512]; /* small: the board's entries come by several calls */
    for (long size; (size = syscall(SYS_getdents64, fd, list, sizeof list)) > 0;)
        for (long at = 0; at < size; at += ((struct dirent64 *)(list + at))->d_reclen)
            add(((struct dirent64 *)(list + at))->d_name);
    print("getdents64");
#ifdef SYS_getdents
    lseek(fd, 0, SEEK_SET);
    for (long size; (size = syscall(SYS_getdents, fd, list, sizeof list)) > 0;)
        for (long at = 0; at < size; at += ((struct older *)(list + at))->length)
            add(((struct older *)(list + at))->name);
#else
    add("0");
#endif
    print("getdents");
    close(fd);
}

static void all(char *path, const char *pattern) {
    printf("%s\n", path);
    by_readdir(path);
    by_scandir(path);
    by_glob(pattern);
    by_fts(path);
    by_calls(path);
}

int main(void) {
    setvbuf(stdout, NULL, _IOLBF, 0);
    for (int i = 0; i < 3; ++i)
        if (fork() == 0) {
            usleep(200000);
            _exit(0);
        }
    usleep(10000);
    all("/proc", "/proc/[0-9]*");
    all("/dev", "/dev/*[0-9]");
    by_nftw("/dev");
    glob_t found = {0};
    glob("/proc/[0-9]*/stat", 0, NULL, &found); /* whether they are there is asked for by name */
    printf("of processes %zu", found.gl_pathc);
    glob("/proc/1001/f?", 0, NULL, &found);
    printf(", %s", found.gl_pathc == 1 ? found.gl_pathv[0] : "none");
    printf(", a device %d, another %d\n", glob("/dev/ttyS0", 0, NULL, &found), glob("/dev/ttyS77", 0, NULL, &found));
    printf("a device is no folder: %d\n", opendir("/dev/ttyS0") == NULL);
    while (wait(NULL) > 0) {
    }
    return 0;
}
