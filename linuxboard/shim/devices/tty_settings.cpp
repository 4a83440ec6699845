#include "linuxboard/shim/devices/tty_settings.h"

#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace puckloop::linuxboard {

namespace {
constexpr std::array<std::pair<speed_t, int>, 30> kSpeeds{{
    {B50, 50},           {B75, 75},           {B110, 110},         {B134, 134},         {B150, 150},
    {B200, 200},         {B300, 300},         {B600, 600},         {B1200, 1200},       {B1800, 1800},
    {B2400, 2400},       {B4800, 4800},       {B9600, 9600},       {B19200, 19200},     {B38400, 38400},
    {B57600, 57600},     {B115200, 115200},   {B230400, 230400},   {B460800, 460800},   {B500000, 500000},
    {B576000, 576000},   {B921600, 921600},   {B1000000, 1000000}, {B1152000, 1152000}, {B1500000, 1500000},
    {B2000000, 2000000}, {B2500000, 2500000}, {B3000000, 3000000}, {B3500000, 3500000}, {B4000000, 4000000},
}};
}  // namespace

termios initial_termios() {
    termios settings;
    std::memset(&settings, 0, sizeof settings);
    settings.c_iflag = ICRNL | IXON;
    settings.c_oflag = OPOST | ONLCR;
    settings.c_cflag = B9600 | CS8 | CREAD | HUPCL | CLOCAL;
    settings.c_lflag = ISIG | ICANON | ECHO | ECHOE | ECHOK | ECHOCTL | ECHOKE | IEXTEN;
    settings.c_ispeed = B9600;
    settings.c_ospeed = B9600;
    constexpr auto control = [](char letter) { return static_cast<cc_t>(letter - '@'); };
    settings.c_cc[VINTR] = control('C');
    settings.c_cc[VQUIT] = control('\\');
    settings.c_cc[VERASE] = 0x7f;
    settings.c_cc[VKILL] = control('U');
    settings.c_cc[VEOF] = control('D');
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VSTART] = control('Q');
    settings.c_cc[VSTOP] = control('S');
    settings.c_cc[VSUSP] = control('Z');
    settings.c_cc[VREPRINT] = control('R');
    settings.c_cc[VDISCARD] = control('O');
    settings.c_cc[VWERASE] = control('W');
    settings.c_cc[VLNEXT] = control('V');
    return settings;
}

int baud_rate(speed_t speed) {
    for (const auto& [code, rate] : kSpeeds) {
        if (code == speed) return rate;
    }
    return 0;
}

cosim::Time bit_period(const termios& settings, double ppm) {
    constexpr int kRateOfNone = 9600;  // serial_core.c: B0 drops DTR, the divisor is that of 9600
    const int set = baud_rate(cfgetospeed(&settings));
    const int rate = set == 0 ? kRateOfNone : set;
    return std::llround(static_cast<double>(cosim::kSecond) / (rate * (1.0 + ppm * 1e-6)));
}

protocols::UartReceiver receiver_of(const termios& settings, double ppm) {
    protocols::UartReceiver receiver;
    receiver.bit_period = bit_period(settings, ppm);
    switch (settings.c_cflag & CSIZE) {
    case CS5:
        receiver.data_bits = 5;
        break;
    case CS6:
        receiver.data_bits = 6;
        break;
    case CS7:
        receiver.data_bits = 7;
        break;
    default:
        receiver.data_bits = 8;
        break;
    }
    if ((settings.c_cflag & PARENB) != 0) receiver.parity = (settings.c_cflag & PARODD) != 0 ? 1 : 2;
    return receiver;
}

}  // namespace puckloop::linuxboard
