// termios and ioctl on the serial port and on the I2C adapter.

#include "linuxboard/shim/preload/files/open_file.h"
#include "linuxboard/shim/preload/real.h"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
/// The kernel's struct termios (asm-generic), which TCGETS and TCSETS carry, and its successor.
struct KernelTermios {
    tcflag_t c_iflag, c_oflag, c_cflag, c_lflag;
    cc_t c_line;
    cc_t c_cc[19];
};
struct KernelTermios2 : KernelTermios {
    speed_t c_ispeed, c_ospeed;
};
constexpr unsigned long kTcGets2 = 0x802c542a;
constexpr unsigned long kTcSets2 = 0x402c542b;
constexpr tcflag_t kOtherBaud = 0010000;  // BOTHER
constexpr std::uint32_t kBreakMicroseconds = 250'000;
constexpr int kModemLines = TIOCM_CTS | TIOCM_CAR | TIOCM_DSR;

struct Rate {
    speed_t code;
    speed_t rate;
};
constexpr Rate kRates[] = {{B1200, 1200},       {B2400, 2400},      {B4800, 4800},     {B9600, 9600},
                           {B19200, 19200},     {B38400, 38400},    {B57600, 57600},   {B115200, 115200},
                           {B230400, 230400},   {B460800, 460800},  {B500000, 500000}, {B921600, 921600},
                           {B1000000, 1000000}, {B2000000, 2000000}};

wire::Request request_for(const OpenFile& file, wire::Op op, std::uint32_t a = 0, std::uint32_t b = 0) {
    wire::Request request;
    request.op = op;
    request.handle = file.handle;
    request.a = a;
    request.b = b;
    return request;
}

int simple(const OpenFile& file, wire::Op op, std::uint32_t a = 0, std::uint32_t b = 0) {
    return static_cast<int>(device_call(request_for(file, op, a, b)));
}

int get_termios(const OpenFile& file, termios& settings) {
    std::memset(&settings, 0, sizeof settings);
    return static_cast<int>(
        device_call(request_for(file, wire::Op::GetTermios), nullptr, 0, &settings, sizeof settings));
}

int set_termios(const OpenFile& file, int when, const termios& settings) {
    return static_cast<int>(
        device_call(request_for(file, wire::Op::SetTermios, static_cast<std::uint32_t>(when)), &settings,
                    sizeof settings));
}

int get_kernel_termios(const OpenFile& file, KernelTermios& out) {
    termios settings;
    if (get_termios(file, settings) != 0) return -1;
    out.c_iflag = settings.c_iflag;
    out.c_oflag = settings.c_oflag;
    out.c_cflag = settings.c_cflag;
    out.c_lflag = settings.c_lflag;
    out.c_line = settings.c_line;
    std::memcpy(out.c_cc, settings.c_cc, sizeof out.c_cc);
    return 0;
}

int set_kernel_termios(const OpenFile& file, int when, const KernelTermios& in, speed_t speed) {
    termios settings;
    std::memset(&settings, 0, sizeof settings);
    settings.c_iflag = in.c_iflag;
    settings.c_oflag = in.c_oflag;
    settings.c_cflag = in.c_cflag;
    settings.c_lflag = in.c_lflag;
    settings.c_line = in.c_line;
    std::memcpy(settings.c_cc, in.c_cc, sizeof in.c_cc);
    cfsetspeed(&settings, speed);
    return set_termios(file, when, settings);
}

int set_kernel_termios2(const OpenFile& file, int when, const KernelTermios2& in) {
    KernelTermios plain = in;
    speed_t speed = in.c_cflag & CBAUD;
    if (speed == kOtherBaud) {
        for (const Rate& known : kRates) {
            if (known.rate == in.c_ospeed) speed = known.code;
        }
        if (speed == kOtherBaud) {
            note("%s: the rate %u baud is not supported", file.path, in.c_ospeed);
            errno = EINVAL;
            return -1;
        }
        plain.c_cflag = (plain.c_cflag & ~static_cast<tcflag_t>(CBAUD)) | speed;
    }
    return set_kernel_termios(file, when, plain, speed);
}

int counters(const OpenFile& file, serial_icounter_struct& out) {
    wire::TtyCounters counted;
    if (device_call(request_for(file, wire::Op::Counters), nullptr, 0, &counted, sizeof counted) < 0)
        return -1;
    std::memset(&out, 0, sizeof out);
    out.rx = static_cast<int>(counted.received);
    out.tx = static_cast<int>(counted.sent);
    out.frame = static_cast<int>(counted.framing);
    out.parity = static_cast<int>(counted.parity);
    out.overrun = static_cast<int>(counted.overrun);
    out.brk = static_cast<int>(counted.breaks);
    out.buf_overrun = static_cast<int>(counted.buffer_overrun);
    return 0;
}

int unsupported(const OpenFile& file, unsigned long request, const void* caller, int error) {
    note("%s: ioctl 0x%lx is not supported (in %s)", file.path, request, place_of(caller));
    errno = error;
    return -1;
}

int tty_ioctl(OpenFile& file, unsigned long request, void* argument, const void* caller) {
    const auto value = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(argument));
    auto* integer = static_cast<int*>(argument);
    static int modem_outputs = TIOCM_DTR | TIOCM_RTS;
    switch (request) {
    case TCGETS:
        return get_kernel_termios(file, *static_cast<KernelTermios*>(argument));
    case TCSETS:
    case TCSETSW:
    case TCSETSF: {
        const auto& in = *static_cast<const KernelTermios*>(argument);
        return set_kernel_termios(file, static_cast<int>(request - TCSETS), in, in.c_cflag & CBAUD);
    }
    case kTcGets2: {
        auto& out = *static_cast<KernelTermios2*>(argument);
        if (get_kernel_termios(file, out) != 0) return -1;
        out.c_ispeed = out.c_ospeed = 0;
        for (const Rate& known : kRates) {
            if (known.code == (out.c_cflag & CBAUD)) out.c_ispeed = out.c_ospeed = known.rate;
        }
        return 0;
    }
    case kTcSets2:
    case kTcSets2 + 1:
    case kTcSets2 + 2:
        return set_kernel_termios2(file, static_cast<int>(request - kTcSets2),
                                   *static_cast<const KernelTermios2*>(argument));
    case TCFLSH:
        return simple(file, wire::Op::Flush, value);
    case TCXONC:
        return simple(file, wire::Op::Flow, value);
    case TCSBRK:
        return value != 0 ? simple(file, wire::Op::Drain)
                          : simple(file, wire::Op::Break, 0, kBreakMicroseconds);
    case TCSBRKP:
        return simple(file, wire::Op::Break, 0, value == 0 ? kBreakMicroseconds : value * 100'000);
    case FIONREAD:
        return (*integer = simple(file, wire::Op::InputQueue)) < 0 ? -1 : 0;
    case TIOCOUTQ:
        return (*integer = simple(file, wire::Op::OutputQueue)) < 0 ? -1 : 0;
    case TIOCMGET:
        *integer = modem_outputs | kModemLines;
        return 0;
    case TIOCMSET:
        modem_outputs = *integer & (TIOCM_DTR | TIOCM_RTS);
        return 0;
    case TIOCMBIS:
        modem_outputs |= *integer & (TIOCM_DTR | TIOCM_RTS);
        return 0;
    case TIOCMBIC:
        modem_outputs &= ~*integer;
        return 0;
    case TIOCGICOUNT:
        return counters(file, *static_cast<serial_icounter_struct*>(argument));
    case TIOCGSERIAL: {
        auto* serial = static_cast<serial_struct*>(argument);
        std::memset(serial, 0, sizeof *serial);
        serial->type = 4;  // PORT_16550A
        serial->baud_base = 921'600;
        serial->xmit_fifo_size = 16;
        return 0;
    }
    case TIOCSSERIAL:
    case TIOCEXCL:
    case TIOCNXCL:
    case TIOCSCTTY:
        return 0;
    case TIOCGWINSZ:
        std::memset(argument, 0, sizeof(winsize));
        return 0;
    case TIOCGPGRP:
    case TIOCSPGRP:
    case TIOCGSID:
    case TIOCNOTTY:
        errno = ENOTTY;
        return -1;
    default:
        return unsupported(file, request, caller, ENOTTY);
    }
}
}  // namespace

int i2c_ioctl(OpenFile& file, unsigned long request, void* argument, const void* caller);

int device_ioctl(OpenFile& file, unsigned long request, void* argument, const void* caller) {
    mark_call("ioctl");
    charge(page().charges.device);
    switch (request) {
    case FIONBIO:
        file.flags = (file.flags & O_ACCMODE) | (*static_cast<int*>(argument) != 0 ? O_NONBLOCK : 0);
        return 0;
    case FIOCLEX:
    case FIONCLEX:
        return 0;
    default:
        break;
    }
    switch (file.kind) {
    case OpenFile::Kind::Tty:
        return tty_ioctl(file, request, argument, caller);
    case OpenFile::Kind::I2c:
        return i2c_ioctl(file, request, argument, caller);
    case OpenFile::Kind::Video:
        return video_ioctl(file, request, argument);
    case OpenFile::Kind::Random:
        break;
    }
    errno = ENOTTY;
    return -1;
}

/// The serial port behind a descriptor; nullptr and ENOTTY for our other devices.
static OpenFile* serial_port(int fd) {
    OpenFile* file = open_file(fd);
    if (file == nullptr) return nullptr;
    charge(page().charges.device);
    return file;
}

}  // namespace puckloop::shim

SHIM_EXPORT int ioctl(int fd, unsigned long request, ...) noexcept {
    std::va_list arguments;
    va_start(arguments, request);
    void* argument = va_arg(arguments, void*);
    va_end(arguments);
    if (OpenFile* file = open_file(fd))
        return device_ioctl(*file, request, argument, __builtin_return_address(0));
    return REAL(ioctl)(fd, request, argument);
}

#define NOT_A_TTY(file)                                                                                      \
    if ((file)->kind != OpenFile::Kind::Tty) {                                                               \
        errno = ENOTTY;                                                                                      \
        return -1;                                                                                           \
    }

SHIM_EXPORT int tcgetattr(int fd, termios* settings) noexcept {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcgetattr)(fd, settings);
    NOT_A_TTY(file)
    mark_call("tcgetattr");
    return get_termios(*file, *settings);
}

SHIM_EXPORT int tcsetattr(int fd, int when, const termios* settings) noexcept {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcsetattr)(fd, when, settings);
    NOT_A_TTY(file)
    mark_call("tcsetattr");
    return set_termios(*file, when, *settings);
}

SHIM_EXPORT int tcflush(int fd, int which) noexcept {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcflush)(fd, which);
    NOT_A_TTY(file)
    return simple(*file, wire::Op::Flush, static_cast<std::uint32_t>(which));
}

SHIM_EXPORT int tcflow(int fd, int action) noexcept {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcflow)(fd, action);
    NOT_A_TTY(file)
    return simple(*file, wire::Op::Flow, static_cast<std::uint32_t>(action));
}

SHIM_EXPORT int tcdrain(int fd) {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcdrain)(fd);
    NOT_A_TTY(file)
    mark_call("tcdrain");
    wire::Request request;
    request.op = wire::Op::Drain;
    request.handle = file->handle;
    return static_cast<int>(device_call(request, nullptr, 0, nullptr, 0, true));
}

SHIM_EXPORT int tcsendbreak(int fd, int duration) noexcept {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcsendbreak)(fd, duration);
    NOT_A_TTY(file)
    return simple(*file, wire::Op::Break, 0, kBreakMicroseconds);
}

SHIM_EXPORT int isatty(int fd) noexcept {
    const OpenFile* file = open_file(fd);
    if (file == nullptr) return REAL(isatty)(fd);
    if (file->kind == OpenFile::Kind::Tty) return 1;
    errno = ENOTTY;
    return 0;
}

SHIM_EXPORT int ttyname_r(int fd, char* name, size_t size) noexcept {
    const OpenFile* file = open_file(fd);
    if (file == nullptr) return REAL(ttyname_r)(fd, name, size);
    if (file->kind != OpenFile::Kind::Tty) return ENOTTY;
    if (std::strlen(file->path) >= size) return ERANGE;
    std::strcpy(name, file->path);
    return 0;
}

SHIM_EXPORT char* ttyname(int fd) noexcept {
    static char name[64];
    if (open_file(fd) == nullptr) return REAL(ttyname)(fd);
    return ttyname_r(fd, name, sizeof name) == 0 ? name : nullptr;
}
