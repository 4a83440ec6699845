#include "linuxboard/shim/devices/line_discipline.h"

#include <unistd.h>

#include <algorithm>

namespace puckloop::linuxboard {

namespace {
constexpr char kMarkByte = '\377';
constexpr char kDelete = '\177';

bool has(tcflag_t flags, tcflag_t bit) {
    return (flags & bit) != 0;
}

bool is_control(const termios& settings, int index, char byte) {
    const cc_t control = settings.c_cc[index];
    return control != _POSIX_VDISABLE && static_cast<char>(control) == byte;
}

std::string echo_of(char byte, const termios& settings) {
    const bool is_ctrl = static_cast<unsigned char>(byte) < ' ' || byte == kDelete;
    if (has(settings.c_lflag, ECHOCTL) && is_ctrl && byte != '\n' && byte != '\t')
        return {'^', byte == kDelete ? '?' : static_cast<char>(byte + '@')};
    return LineDiscipline::output(byte, settings);
}
}  // namespace

void LineDiscipline::push(char byte, bool ends_line, bool is_end_of_file) {
    if (buffer_.size() >= kBufferSize) {
        ++dropped_;
        return;
    }
    buffer_.push_back({byte, ends_line, is_end_of_file});
    if (ends_line) ++lines_;
}

void LineDiscipline::erase_last(Effect& effect, const termios& settings) {
    if (buffer_.empty() || buffer_.back().ends_line) return;
    buffer_.pop_back();
    if (has(settings.c_lflag, ECHO) && has(settings.c_lflag, ECHOE)) effect.echo += "\b \b";
}

LineDiscipline::Effect LineDiscipline::receive(const protocols::ReceivedCharacter& character,
                                               const termios& settings) {
    Effect effect;
    const tcflag_t in = settings.c_iflag;
    char byte = static_cast<char>(character.data);
    if (character.is_break) {
        if (has(in, IGNBRK)) return effect;
        if (has(in, BRKINT)) {
            discard();
            return effect;
        }
        if (has(in, PARMRK)) {
            push(kMarkByte);
            push(0);
        }
        push(0);
        return effect;
    }
    const bool bad = character.framing_error || (character.parity_error && has(in, INPCK));
    if (bad) {
        if (has(in, IGNPAR)) return effect;
        if (has(in, PARMRK)) {
            push(kMarkByte);
            push(0);
            push(byte);
        } else {
            push(character.parity_error && !character.framing_error ? 0 : byte);
        }
        return effect;
    }
    if (has(in, ISTRIP)) byte = static_cast<char>(byte & 0x7f);
    if (has(in, PARMRK) && byte == kMarkByte) push(byte);
    if (has(in, IXON)) {
        if (is_control(settings, VSTOP, byte)) {
            effect.stop_output = true;
            return effect;
        }
        if (is_control(settings, VSTART, byte)) {
            effect.start_output = true;
            return effect;
        }
        if (has(in, IXANY)) effect.start_output = true;
    }
    if (has(settings.c_lflag, ISIG) &&
        (is_control(settings, VINTR, byte) || is_control(settings, VQUIT, byte) ||
         is_control(settings, VSUSP, byte)))
        return effect;
    if (byte == '\r') {
        if (has(in, IGNCR)) return effect;
        if (has(in, ICRNL)) byte = '\n';
    } else if (byte == '\n' && has(in, INLCR)) {
        byte = '\r';
    }
    if (has(settings.c_lflag, ICANON)) {
        if (is_control(settings, VERASE, byte)) {
            erase_last(effect, settings);
            return effect;
        }
        if (is_control(settings, VKILL, byte)) {
            while (!buffer_.empty() && !buffer_.back().ends_line)
                buffer_.pop_back();
            return effect;
        }
        if (is_control(settings, VEOF, byte)) {
            push(0, true, true);
            return effect;
        }
    }
    if (has(settings.c_lflag, ECHO) || (byte == '\n' && has(settings.c_lflag, ECHONL)))
        effect.echo += echo_of(byte, settings);
    const bool ends_line =
        has(settings.c_lflag, ICANON) &&
        (byte == '\n' || is_control(settings, VEOL, byte) || is_control(settings, VEOL2, byte));
    push(byte, ends_line);
    return effect;
}

std::string LineDiscipline::output(char byte, const termios& settings) {
    if (!has(settings.c_oflag, OPOST)) return {byte};
    if (byte == '\n' && has(settings.c_oflag, ONLCR)) return "\r\n";
    if (byte == '\r' && has(settings.c_oflag, OCRNL)) return "\n";
    return {byte};
}

std::size_t LineDiscipline::readable(const termios& settings) const {
    if (!has(settings.c_lflag, ICANON)) return buffer_.size();
    if (lines_ == 0) return 0;
    const auto end =
        std::find_if(buffer_.begin(), buffer_.end(), [](const Item& item) { return item.ends_line; });
    return static_cast<std::size_t>(end - buffer_.begin()) + (end->is_end_of_file ? 0 : 1);
}

std::size_t LineDiscipline::queued(const termios& settings) const {
    return has(settings.c_lflag, ICANON) ? readable(settings) : buffer_.size();
}

std::string LineDiscipline::take(std::size_t most, const termios& settings) {
    std::string data;
    const bool canonical = has(settings.c_lflag, ICANON);
    while (!buffer_.empty() && data.size() < most) {
        const Item item = buffer_.front();
        buffer_.pop_front();
        if (item.ends_line) --lines_;
        if (canonical && item.is_end_of_file) break;
        data += item.byte;
        if (canonical && item.ends_line) break;
    }
    return data;
}

void LineDiscipline::copy(std::size_t most, char* out) const {
    for (std::size_t i = 0; i < std::min(most, buffer_.size()); ++i)
        out[i] = buffer_[i].byte;
}

void LineDiscipline::discard() {
    buffer_.clear();
    lines_ = 0;
}

}  // namespace puckloop::linuxboard
