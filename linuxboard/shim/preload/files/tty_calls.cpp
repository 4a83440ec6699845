// termios and ioctl on the serial port and on the I2C adapter.

#include "linuxboard/shim/preload/descriptors/device_numbers.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/network/sockets.h"

#include <fcntl.h>
#include <linux/fs.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
/// What a terminal keeps and nothing here obeys; of this process and its children to come.
struct Kept {
    winsize window{};
    bool exclusive = false;
};
Kept& kept_of(const OpenFile& file) {
    constexpr std::size_t kMost = 16;
    static Kept kept[kMost];
    return kept[static_cast<std::size_t>(std::max(file.device, 0)) % kMost];
}

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
constexpr std::uint32_t kMostBreak = 36'000;  // tenths of a second: one hour
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
            return fail(EINVAL);
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
    return fail(error);
}

/// The older struct of TCGETA and TCSETA.
struct KernelTermio {
    unsigned short c_iflag, c_oflag, c_cflag, c_lflag;
    unsigned char c_line, c_cc[8];
};

int put_number(void* argument, int number) {
    return number >= 0 && put_to_program(argument, number) ? 0 : -1;
}

int send_break(const OpenFile& file, std::uint32_t microseconds) {
    return static_cast<int>(
        device_call(request_for(file, wire::Op::Break, 0, microseconds), nullptr, 0, nullptr, 0, true));
}

int drain(const OpenFile& file) {
    return static_cast<int>(device_call(request_for(file, wire::Op::Drain), nullptr, 0, nullptr, 0, true));
}

int get_old_termio(const OpenFile& file, void* argument) {
    KernelTermios settings{};
    if (get_kernel_termios(file, settings) != 0) return -1;
    KernelTermio old{};
    old.c_iflag = static_cast<unsigned short>(settings.c_iflag);
    old.c_oflag = static_cast<unsigned short>(settings.c_oflag);
    old.c_cflag = static_cast<unsigned short>(settings.c_cflag);
    old.c_lflag = static_cast<unsigned short>(settings.c_lflag);
    old.c_line = settings.c_line;
    std::memcpy(old.c_cc, settings.c_cc, sizeof old.c_cc);
    return put_to_program(argument, old) ? 0 : -1;
}

int set_old_termio(const OpenFile& file, int when, const void* argument) {
    KernelTermio old{};
    KernelTermios settings{};
    if (!get_from_program(old, argument) || get_kernel_termios(file, settings) != 0) return -1;
    const auto low = [](tcflag_t& flags, unsigned short bits) { flags = (flags & ~tcflag_t{0xffff}) | bits; };
    low(settings.c_iflag, old.c_iflag);
    low(settings.c_oflag, old.c_oflag);
    low(settings.c_cflag, old.c_cflag);
    low(settings.c_lflag, old.c_lflag);
    settings.c_line = old.c_line;
    std::memcpy(settings.c_cc, old.c_cc, sizeof old.c_cc);
    return set_kernel_termios(file, when, settings, settings.c_cflag & CBAUD);
}

/// TIOCMGET and its kin: the lines' outputs are stored, the inputs read as set.
int modem_ioctl(unsigned long request, void* argument) {
    static int outputs = TIOCM_DTR | TIOCM_RTS;
    constexpr int kOutputs = TIOCM_DTR | TIOCM_RTS;
    if (request == TIOCMGET) return put_number(argument, outputs | kModemLines);
    int lines = 0;
    if (!get_from_program(lines, argument)) return -1;
    lines &= kOutputs;
    outputs = request == TIOCMSET ? lines : request == TIOCMBIS ? outputs | lines : outputs & ~lines;
    return 0;
}

int get_speeds(const OpenFile& file, void* argument) {
    KernelTermios2 out{};
    if (get_kernel_termios(file, out) != 0) return -1;
    out.c_ispeed = out.c_ospeed = 0;
    for (const Rate& known : kRates)
        if (known.code == (out.c_cflag & CBAUD)) out.c_ispeed = out.c_ospeed = known.rate;
    return put_to_program(argument, out) ? 0 : -1;
}

int get_serial(void* argument) {
    serial_struct serial{};
    serial.type = 4;  // PORT_16550A
    serial.baud_base = 921'600;
    serial.xmit_fifo_size = 16;
    return put_to_program(argument, serial) ? 0 : -1;
}

int set_discipline(const OpenFile& file, void* argument) {
    int number = 0;
    if (!get_from_program(number, argument)) return -1;
    if (number == N_TTY) return 0;
    note("%s: the line discipline %d is not supported", file.path, number);
    return fail(EINVAL);
}

int flush(const OpenFile& file, std::uint32_t which) {
    return which > TCIOFLUSH ? fail(EINVAL) : simple(file, wire::Op::Flush, which);
}

int flow(const OpenFile& file, std::uint32_t action) {
    return action > TCION ? fail(EINVAL) : simple(file, wire::Op::Flow, action);
}

int tty_ioctl(OpenFile& file, unsigned long request, void* argument, const void* caller) {
    const auto value = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(argument));
    switch (request) {
    case TCGETS: {
        KernelTermios out{};
        return get_kernel_termios(file, out) == 0 && put_to_program(argument, out) ? 0 : -1;
    }
    case TCSETS:
    case TCSETSW:
    case TCSETSF: {
        KernelTermios in{};
        if (!get_from_program(in, argument)) return -1;
        return set_kernel_termios(file, static_cast<int>(request - TCSETS), in, in.c_cflag & CBAUD);
    }
    case kTcGets2:
        return get_speeds(file, argument);
    case kTcSets2:
    case kTcSets2 + 1:
    case kTcSets2 + 2: {
        KernelTermios2 in{};
        if (!get_from_program(in, argument)) return -1;
        return set_kernel_termios2(file, static_cast<int>(request - kTcSets2), in);
    }
    case TCGETA:
        return get_old_termio(file, argument);
    case TCSETA:
    case TCSETAW:
    case TCSETAF:
        return set_old_termio(file, static_cast<int>(request - TCSETA), argument);
    case TCFLSH:
        return flush(file, value);
    case TCXONC:
        return flow(file, value);
    case TCSBRK:
        return value != 0 ? drain(file) : send_break(file, kBreakMicroseconds);
    case TCSBRKP:
        return send_break(file, value == 0 ? kBreakMicroseconds
                                           : std::min<std::uint32_t>(value, kMostBreak) * 100'000);
    case FIONREAD:
        return put_number(argument, simple(file, wire::Op::InputQueue));
    case TIOCOUTQ:
        return put_number(argument, simple(file, wire::Op::OutputQueue));
    case TIOCMGET:
    case TIOCMSET:
    case TIOCMBIS:
    case TIOCMBIC:
        return modem_ioctl(request, argument);
    case TIOCGICOUNT: {
        serial_icounter_struct counted{};
        return counters(file, counted) == 0 && put_to_program(argument, counted) ? 0 : -1;
    }
    case TIOCGSERIAL:
        return get_serial(argument);
    case TIOCSSERIAL: {
        serial_struct serial{};
        return get_from_program(serial, argument) ? 0 : -1;
    }
    case TIOCGSOFTCAR: {
        KernelTermios settings{};
        return get_kernel_termios(file, settings) != 0
                   ? -1
                   : put_number(argument, (settings.c_cflag & CLOCAL) != 0 ? 1 : 0);
    }
    case TIOCGETD:
        return put_number(argument, N_TTY);
    case TIOCSETD:
        return set_discipline(file, argument);
    case TIOCGDEV: {
        const auto number = static_cast<unsigned>(device_number(file));
        return put_to_program(argument, number) ? 0 : -1;
    }
    case TIOCGEXCL:
        return put_number(argument, kept_of(file).exclusive ? 1 : 0);
    case TIOCEXCL:  // without effect on a superuser, whom programs of the board run as
    case TIOCNXCL:
        kept_of(file).exclusive = request == TIOCEXCL;
        return 0;
    case TIOCSTI: {
        unsigned char byte = 0;
        return get_from_program(byte, argument) ? simple(file, wire::Op::Insert, byte) : -1;
    }
    case TIOCSCTTY:
        return 0;
    case TIOCGWINSZ:
        return put_to_program(argument, kept_of(file).window) ? 0 : -1;
    case TIOCSWINSZ:
        return get_from_program(kept_of(file).window, argument) ? 0 : -1;
    case TIOCGPGRP:
    case TIOCSPGRP:
    case TIOCGSID:
    case TIOCNOTTY:
        return fail(ENOTTY);
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
    case FIGETBSZ:  // of the file system with the devices
        return put_number(argument, 4096);
    case FIONBIO: {
        int on = 0;
        if (!get_from_program(on, argument)) return -1;
        file.flags = (file.flags & ~O_NONBLOCK) | (on != 0 ? O_NONBLOCK : 0);
        return 0;
    }
    case FIOASYNC: {
        int on = 0;
        if (!get_from_program(on, argument)) return -1;
        if (on != 0) note("%s: O_ASYNC (SIGIO) is not supported", file.path);
        return 0;
    }
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
    case OpenFile::Kind::Socket:
        return socket_ioctl(file, request, argument);
    case OpenFile::Kind::Random:
        break;
    }
    return fail(ENOTTY);
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
    OpenFile* file = open_file(fd);
    if (file != nullptr && request != FIOCLEX && request != FIONCLEX)
        return device_ioctl(*file, static_cast<std::uint32_t>(request), argument,
                            __builtin_return_address(0));
    if (active() && is_link_descriptor(fd)) return fail(EBADF);
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
    termios current;
    if (get_termios(*file, current) != 0) return -1;
    return put_to_program(settings, current) ? 0 : -1;
}

SHIM_EXPORT int tcsetattr(int fd, int when, const termios* settings) noexcept {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcsetattr)(fd, when, settings);
    NOT_A_TTY(file)
    mark_call("tcsetattr");
    termios wanted;
    if (when < TCSANOW || when > TCSAFLUSH) return fail(EINVAL);
    return get_from_program(wanted, settings) ? set_termios(*file, when, wanted) : -1;
}

SHIM_EXPORT int tcflush(int fd, int which) noexcept {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcflush)(fd, which);
    NOT_A_TTY(file)
    return flush(*file, static_cast<std::uint32_t>(which));
}

SHIM_EXPORT int tcflow(int fd, int action) noexcept {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcflow)(fd, action);
    NOT_A_TTY(file)
    return flow(*file, static_cast<std::uint32_t>(action));
}

SHIM_EXPORT int tcdrain(int fd) {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcdrain)(fd);
    NOT_A_TTY(file)
    mark_call("tcdrain");
    return drain(*file);
}

SHIM_EXPORT int tcsendbreak(int fd, int duration) noexcept {
    OpenFile* file = serial_port(fd);
    if (file == nullptr) return REAL(tcsendbreak)(fd, duration);
    NOT_A_TTY(file)
    mark_call("tcsendbreak");
    // As the C library does it: 0.25 s, or as many tenths of a second as come closest from above.
    if (duration <= 0) return send_break(*file, kBreakMicroseconds);
    return send_break(*file,
                      std::min<std::uint32_t>((static_cast<std::uint32_t>(duration) + 99) / 100, kMostBreak) *
                          100'000);
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
    return copy_to_program(name, file->path, std::strlen(file->path) + 1) ? 0 : EFAULT;
}

SHIM_EXPORT char* ttyname(int fd) noexcept {
    static char name[64];
    if (open_file(fd) == nullptr) return REAL(ttyname)(fd);
    return ttyname_r(fd, name, sizeof name) == 0 ? name : nullptr;
}
