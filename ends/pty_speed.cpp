#include "ends/pty_speed.h"

// Not <termios.h>: its calls know the listed rates only.
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <array>
#include <cmath>

// <asm/ioctls.h> has these in terms of a struct that <asm/termbits.h> declares.
#include <asm/ioctls.h>

namespace puckloop::exec {

namespace {

struct ListedRate {
    unsigned baud;
    tcflag_t code;
};

/// Programs that look at the settings with <termios.h> understand these.
constexpr std::array kListed{
    ListedRate{50, B50},           ListedRate{75, B75},           ListedRate{110, B110},
    ListedRate{134, B134},         ListedRate{150, B150},         ListedRate{200, B200},
    ListedRate{300, B300},         ListedRate{600, B600},         ListedRate{1200, B1200},
    ListedRate{1800, B1800},       ListedRate{2400, B2400},       ListedRate{4800, B4800},
    ListedRate{9600, B9600},       ListedRate{19200, B19200},     ListedRate{38400, B38400},
    ListedRate{57600, B57600},     ListedRate{115200, B115200},   ListedRate{230400, B230400},
    ListedRate{460800, B460800},   ListedRate{500000, B500000},   ListedRate{576000, B576000},
    ListedRate{921600, B921600},   ListedRate{1000000, B1000000}, ListedRate{1152000, B1152000},
    ListedRate{1500000, B1500000}, ListedRate{2000000, B2000000}, ListedRate{2500000, B2500000},
    ListedRate{3000000, B3000000}, ListedRate{3500000, B3500000}, ListedRate{4000000, B4000000},
};

tcflag_t code_of(unsigned baud) {
    for (const ListedRate& rate : kListed)
        if (rate.baud == baud) return rate.code;
    return BOTHER;
}

}  // namespace

std::optional<double> terminal_baud(int terminal) {
    termios2 settings{};
    if (ioctl(terminal, TCGETS2, &settings) != 0) return std::nullopt;
    if ((settings.c_cflag & CBAUD) == B0) return 0.0;
    return settings.c_ospeed;
}

bool set_raw_terminal(int terminal, double baud) {
    termios2 settings{};
    if (ioctl(terminal, TCGETS2, &settings) != 0) return false;
    const auto rate = static_cast<unsigned>(std::lround(baud));
    settings.c_iflag = 0;
    settings.c_oflag = 0;
    settings.c_lflag = 0;
    settings.c_cflag = CS8 | CREAD | CLOCAL | code_of(rate);
    settings.c_ispeed = settings.c_ospeed = rate;
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
    return ioctl(terminal, TCSETS2, &settings) == 0;
}

}  // namespace puckloop::exec
