#define _GNU_SOURCE
/* A V4L2 program as they are written everywhere: plain system calls, MMAP buffers. The first argument states
   what it does; it prints what a test compares. */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char* kDevice = "/dev/video1";
static int fd = -1;
static unsigned char* frame[16];
static size_t length[16];
static unsigned buffers;

static const char* outcome(int result) {
    return result == 0 ? "ok" : strerrorname_np(errno);
}

static void say(const char* what, int result) {
    printf("%s %s\n", what, outcome(result));
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static void format(unsigned width, unsigned height, unsigned fourcc) {
    struct v4l2_format f;
    memset(&f, 0, sizeof f);
    f.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    f.fmt.pix.width = width;
    f.fmt.pix.height = height;
    f.fmt.pix.pixelformat = fourcc;
    f.fmt.pix.field = V4L2_FIELD_INTERLACED;
    int result = ioctl(fd, VIDIOC_S_FMT, &f);
    printf("format %s %ux%u %.4s field %u line %u size %u\n", outcome(result), f.fmt.pix.width,
           f.fmt.pix.height, (char*)&f.fmt.pix.pixelformat, f.fmt.pix.field, f.fmt.pix.bytesperline,
           f.fmt.pix.sizeimage);
}

static int request(unsigned count, unsigned memory) {
    struct v4l2_requestbuffers r;
    memset(&r, 0, sizeof r);
    r.count = count;
    r.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    r.memory = memory;
    int result = ioctl(fd, VIDIOC_REQBUFS, &r);
    buffers = result == 0 ? r.count : 0;
    return result;
}

static struct v4l2_buffer buffer_of(unsigned index) {
    struct v4l2_buffer b;
    memset(&b, 0, sizeof b);
    b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    b.memory = V4L2_MEMORY_MMAP;
    b.index = index;
    return b;
}

static int queue(unsigned index) {
    struct v4l2_buffer b = buffer_of(index);
    return ioctl(fd, VIDIOC_QBUF, &b);
}

static int stream(int on) {
    enum v4l2_buf_type type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    return ioctl(fd, on ? VIDIOC_STREAMON : VIDIOC_STREAMOFF, &type);
}

static void map_all(void) {
    for (unsigned i = 0; i < buffers; i++) {
        struct v4l2_buffer b = buffer_of(i);
        if (ioctl(fd, VIDIOC_QUERYBUF, &b) != 0) exit(20);
        length[i] = b.length;
        frame[i] = mmap(NULL, b.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, b.m.offset);
        if (frame[i] == MAP_FAILED) exit(21);
    }
}

static void begin(unsigned width, unsigned height, unsigned fourcc, unsigned count) {
    format(width, height, fourcc);
    if (request(count, V4L2_MEMORY_MMAP) != 0) exit(22);
    map_all();
    for (unsigned i = 0; i < buffers; i++)
        if (queue(i) != 0) exit(23);
    if (stream(1) != 0) exit(24);
}

/* Sequence number, time of the stamp and of now, sum of all bytes. */
static int take(int give_back) {
    struct v4l2_buffer b = buffer_of(0);
    if (ioctl(fd, VIDIOC_DQBUF, &b) != 0) {
        say("take", -1);
        return -1;
    }
    unsigned long sum = 0;
    for (unsigned i = 0; i < b.bytesused; i++)
        sum = sum * 31 + frame[b.index][i];
    printf("frame %u used %u stamp %.6f now %.6f sum %lx\n", b.sequence, b.bytesused,
           (double)b.timestamp.tv_sec + (double)b.timestamp.tv_usec * 1e-6, now(), sum);
    if (give_back && queue(b.index) != 0) exit(25);
    return (int)b.index;
}

static void conform(void) {
    struct stat status = {0};
    int seen = stat(kDevice, &status);
    printf("access %d stat %d chr %d\n", access(kDevice, R_OK | W_OK), seen, S_ISCHR(status.st_mode) != 0);
    struct v4l2_capability c;
    say("querycap", ioctl(fd, VIDIOC_QUERYCAP, &c));
    printf("card %s caps %d %d\n", c.card, (c.device_caps & V4L2_CAP_VIDEO_CAPTURE) != 0,
           (c.device_caps & V4L2_CAP_STREAMING) != 0);
    struct v4l2_fmtdesc d;
    memset(&d, 0, sizeof d);
    d.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    for (; ioctl(fd, VIDIOC_ENUM_FMT, &d) == 0; d.index++) {
        printf("has %.4s:", (char*)&d.pixelformat);
        struct v4l2_frmsizeenum s = {.pixel_format = d.pixelformat};
        for (; ioctl(fd, VIDIOC_ENUM_FRAMESIZES, &s) == 0; s.index++)
            printf(" %ux%u", s.discrete.width, s.discrete.height);
        struct v4l2_frmivalenum v = {.pixel_format = d.pixelformat, .width = 352, .height = 288};
        for (; ioctl(fd, VIDIOC_ENUM_FRAMEINTERVALS, &v) == 0; v.index++)
            printf(" %u/%u", v.discrete.numerator, v.discrete.denominator);
        printf("\n");
    }
    say("end of formats", -1);
    struct v4l2_cropcap crop = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
    int result = ioctl(fd, VIDIOC_CROPCAP, &crop);
    printf("cropcap %s %ux%u\n", outcome(result), crop.defrect.width, crop.defrect.height);
    struct v4l2_crop set = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .c = crop.defrect};
    say("crop", ioctl(fd, VIDIOC_S_CROP, &set));
    /* As a program with int requests calls it. */
    int number = (int)VIDIOC_G_INPUT, input = 7;
    result = ioctl(fd, (unsigned long)number, &input);
    printf("input %s %d\n", outcome(result), input);
    for (struct v4l2_queryctrl q = {.id = V4L2_CTRL_FLAG_NEXT_CTRL}; ioctl(fd, VIDIOC_QUERYCTRL, &q) == 0;
         q.id |= V4L2_CTRL_FLAG_NEXT_CTRL)
        printf("control %x %s %d..%d %d\n", q.id, q.name, q.minimum, q.maximum, q.default_value);
    struct v4l2_control gain = {V4L2_CID_GAIN, 28};
    say("gain", ioctl(fd, VIDIOC_S_CTRL, &gain));
    struct v4l2_control exposure = {V4L2_CID_EXPOSURE, 1};
    say("exposure", ioctl(fd, VIDIOC_S_CTRL, &exposure));
    struct v4l2_ext_control two[2] = {{.id = V4L2_CID_GAIN}, {.id = V4L2_CID_SATURATION}};
    struct v4l2_ext_controls list = {.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 2, .controls = two};
    result = ioctl(fd, VIDIOC_G_EXT_CTRLS, &list);
    printf("both %s %d %d\n", outcome(result), two[0].value, two[1].value);
    two[1].id = V4L2_CID_EXPOSURE;
    result = ioctl(fd, VIDIOC_TRY_EXT_CTRLS, &list);
    printf("try %s at %u\n", outcome(result), list.error_idx);
    struct v4l2_streamparm parm = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
    parm.parm.capture.timeperframe = (struct v4l2_fract){1, 12};
    result = ioctl(fd, VIDIOC_S_PARM, &parm);
    printf("rate %s %u/%u\n", outcome(result), parm.parm.capture.timeperframe.numerator,
           parm.parm.capture.timeperframe.denominator);
    format(350, 290, V4L2_PIX_FMT_YUYV);
    format(9999, 1, V4L2_PIX_FMT_MJPEG);
    say("user pointers", request(2, V4L2_MEMORY_USERPTR));
    say("nothing to stream", stream(1));
    say("buffers", request(2, V4L2_MEMORY_MMAP));
    printf("granted %u\n", buffers);
    struct v4l2_buffer b = buffer_of(2);
    say("no such buffer", ioctl(fd, VIDIOC_QUERYBUF, &b));
    say("not streaming", take(0) < 0 ? -1 : 0);
    say("queue", queue(0));
    say("twice", queue(0));
    void* nowhere = mmap(NULL, 4096, PROT_READ, MAP_SHARED, fd, 12345 * 4096);
    say("map nowhere", nowhere == MAP_FAILED ? -1 : 0);
    void* copy = mmap(NULL, 4096, PROT_READ, MAP_PRIVATE, fd, 0);
    say("map private", copy == MAP_FAILED ? -1 : 0);
    format(320, 240, V4L2_PIX_FMT_YUYV); /* EBUSY: there are buffers */
    int other = open(kDevice, O_RDWR | O_NONBLOCK);
    struct v4l2_requestbuffers r = {
        .count = 1, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
    say("another file", ioctl(other, VIDIOC_REQBUFS, &r));
    say("querycap there", ioctl(other, VIDIOC_QUERYCAP, &c));
    close(other);
    struct v4l2_exportbuffer e = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
    say("export", ioctl(fd, VIDIOC_EXPBUF, &e));
    say("seek", lseek(fd, 0, SEEK_SET) == 0 ? 0 : -1);
    char byte = 0;
    say("write", write(fd, &byte, 1) == 1 ? 0 : -1);
    say("unknown", ioctl(fd, _IOWR('V', 200, int), &input));
    say("unknown again", ioctl(fd, _IOWR('V', 200, int), &input));
    say("of another kind", ioctl(fd, 0x5401, &input));
}

static void* wait_for_frame(void* nothing) {
    struct v4l2_buffer b = buffer_of(0);
    int result = ioctl(fd, VIDIOC_DQBUF, &b);
    printf("waited %s until %.3f\n", outcome(result), now());
    return nothing;
}

int main(int argc, char** argv) {
    const char* mode = argc > 1 ? argv[1] : "conform";
    int count = argc > 2 ? atoi(argv[2]) : 5;
    int flags = O_RDWR;
    if (strcmp(mode, "select") == 0 || strcmp(mode, "nonblocking") == 0) flags |= O_NONBLOCK;
    fd = open(kDevice, flags);
    if (fd < 0) {
        printf("open %s\n", strerrorname_np(errno));
        return 3;
    }
    if (strcmp(mode, "conform") == 0) {
        conform();
    } else if (strcmp(mode, "stream") == 0) {
        begin(352, 288, V4L2_PIX_FMT_YUYV, 2);
        for (int i = 0; i < count; i++)
            take(1);
        say("off", stream(0));
        for (unsigned i = 0; i < buffers; i++)
            say("unmap", munmap(frame[i], length[i]));
        say("free", request(0, V4L2_MEMORY_MMAP));
    } else if (strcmp(mode, "slow") == 0) { /* half a second for each frame */
        begin(176, 144, V4L2_PIX_FMT_GREY, 3);
        for (int i = 0; i < count; i++) {
            take(1);
            usleep(500000);
        }
    } else if (strcmp(mode, "select") == 0) { /* the time-out is shorter than a frame; then a long one */
        begin(160, 120, V4L2_PIX_FMT_RGB565, 2);
        for (int i = 0, expired = 0; i < count;) {
            fd_set set;
            FD_ZERO(&set);
            FD_SET(fd, &set);
            struct timeval wait = {0, i == 0 ? 10000 : 5000000};
            int ready = select(fd + 1, &set, NULL, NULL, &wait);
            if (ready == 0) {
                if (++expired > 10) return 4;
                printf("expired\n");
                continue;
            }
            take(1);
            i++;
        }
        /* Nothing is queued any more: no frame comes, and poll() reports that at once. */
        stream(0);
        stream(1);
        struct pollfd entry = {fd, POLLIN, 0};
        double before = now();
        int ready = poll(&entry, 1, 200);
        printf("poll %d %x after %.3f\n", ready, entry.revents, now() - before);
        stream(0);
        ready = poll(&entry, 1, 200);
        printf("stopped %d %d\n", ready, (entry.revents & POLLERR) != 0);
        queue(0);
        stream(1);
        int epoll = epoll_create1(0);
        struct epoll_event event = {.events = EPOLLIN, .data.fd = 42};
        say("epoll", epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event));
        memset(&event, 0, sizeof event);
        ready = epoll_wait(epoll, &event, 1, 1000);
        printf("epoll %d %d\n", ready, event.data.fd);
        take(0);
    } else if (strcmp(mode, "nonblocking") == 0) {
        begin(160, 120, V4L2_PIX_FMT_GREY, 2);
        take(1);
        usleep(100000);
        take(1);
    } else if (strcmp(mode, "read") == 0) {
        format(160, 120, V4L2_PIX_FMT_GREY);
        static unsigned char picture[160 * 120 + 1000];
        for (int i = 0; i < count; i++) {
            /* In two parts. */
            long first = read(fd, picture, 1000), rest = read(fd, picture + 1000, 160 * 120);
            unsigned long sum = 0;
            for (unsigned k = 0; k < 160 * 120; k++)
                sum = sum * 31 + picture[k];
            printf("read %ld %ld sum %lx at %.6f\n", first, rest, sum, now());
        }
        say("buffers while reading", request(2, V4L2_MEMORY_MMAP));
    } else if (strcmp(mode, "close") == 0) { /* while streaming; the next one begins anew */
        begin(160, 120, V4L2_PIX_FMT_GREY, 2);
        take(1);
        close(fd);
        printf("still there %u\n", frame[0] != NULL ? 1u + (frame[0][0] & 0u) : 0u);
        fd = open(kDevice, O_RDWR);
        begin(160, 120, V4L2_PIX_FMT_GREY, 2);
        take(1);
    } else if (strcmp(mode, "fork") == 0) { /* the child takes frames of its parent's stream */
        begin(160, 120, V4L2_PIX_FMT_GREY, 4);
        take(1);
        fflush(stdout);
        pid_t child = fork();
        if (child == 0) {
            take(1);
            fflush(stdout);
            close(fd);
            _exit(7);
        }
        int status = 0;
        waitpid(child, &status, 0);
        printf("child %d\n", WEXITSTATUS(status));
        take(1);
    } else if (strcmp(mode, "threads") == 0) { /* one waits for a frame, the other one ends the stream */
        begin(160, 120, V4L2_PIX_FMT_GREY, 1);
        take(0);
        pthread_t other;
        pthread_create(&other, NULL, wait_for_frame, NULL);
        double started = now();
        usleep(200000);
        say("off", stream(0));
        pthread_join(other, NULL);
        printf("joined after %.3f\n", now() - started);
        /* Who has the highest priority changes the device; nobody else. */
        int second = open(kDevice, O_RDWR | O_NONBLOCK);
        unsigned priority = V4L2_PRIORITY_RECORD;
        say("record", ioctl(fd, VIDIOC_S_PRIORITY, &priority));
        struct v4l2_control gain = {V4L2_CID_GAIN, 30};
        say("gain elsewhere", ioctl(second, VIDIOC_S_CTRL, &gain));
        say("gain here", ioctl(fd, VIDIOC_S_CTRL, &gain));
        close(fd);
        fd = second;
        say("gain now", ioctl(second, VIDIOC_S_CTRL, &gain));
    } else if (strcmp(mode, "stuck") == 0) { /* waits for a frame that never comes */
        begin(160, 120, V4L2_PIX_FMT_GREY, 1);
        take(0);
        take(0);
    }
    close(fd);
    return 0;
}
