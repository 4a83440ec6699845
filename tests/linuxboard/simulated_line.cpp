#include "tests/linuxboard/simulated_line.h"

#include <algorithm>

namespace puckloop::control {

using namespace protocols;

namespace {

constexpr double kByteTime = 10.0 / 115200;
constexpr double kWorkTime = 0.0003;  // the PIC between the last byte in and the first byte out
constexpr double kNever = 1e300;

}  // namespace

void SimulatedPic::restart(double time) {
    state_ = State::Booting;
    buffer_.clear();
    boot_began_ = time;
    busy_until_ = time + character_.boot;
}

void SimulatedPic::receive(double time, std::uint8_t byte) {
    if (state_ == State::Booting && time < boot_began_ + character_.deaf) return;
    drop_part(time);
    last_byte_ = time;
    if (state_ == State::Waiting && buffer_.empty()) busy_until_ = time + character_.waiting_poll;
    buffer_.push_back(byte);
    advance(time);
}

/// Our firmware's way with a part of a record followed by silence (firmware/epuck/session.c).
void SimulatedPic::drop_part(double time) {
    if (character_.partial_timeout <= 0 || time - last_byte_ <= character_.partial_timeout) return;
    if (state_ == State::Configuration) {
        state_ = State::Waiting;
    } else if (state_ == State::Records && !buffer_.empty()) {
        const bool started_anew =
            buffer_.size() == 1 + kEpuckConfigurationBytes && buffer_[0] == kEpuckWakeUp;
        sessions += started_anew ? 1 : 0;
        answers.push_back(time + kWorkTime);
    } else {
        return;
    }
    buffer_.clear();
}

void SimulatedPic::advance(double time) {
    drop_part(time);
    if (state_ == State::Booting && time >= busy_until_) state_ = State::Waiting;
    if (state_ != State::Booting) consume(time);
}

void SimulatedPic::consume(double time) {
    if (state_ == State::Waiting) {
        if (buffer_.empty() || time < busy_until_) return;
        buffer_.pop_front();
        ++sessions;
        state_ = State::Configuration;
    }
    if (state_ == State::Configuration) {
        if (buffer_.size() < kEpuckConfigurationBytes) return;
        buffer_.erase(buffer_.begin(), buffer_.begin() + kEpuckConfigurationBytes);
        state_ = State::Records;
        answers.push_back(time + kWorkTime);
    }
    while (state_ == State::Records && buffer_.size() >= kEpuckActuatorBytes) {
        EpuckActuatorBytes bytes{};
        std::copy_n(buffer_.begin(), kEpuckActuatorBytes, bytes.begin());
        buffer_.erase(buffer_.begin(), buffer_.begin() + kEpuckActuatorBytes);
        obeyed.push_back(decode_actuators(bytes));
        if (obeyed.back().reset == kEpuckEnd) {
            state_ = State::Waiting;
            busy_until_ = time + character_.waiting_poll;
        } else {
            answers.push_back(time + kWorkTime);
        }
    }
}

void SimulatedLine::put_answer(double begin) {
    const EpuckSensorBytes record = encode(sensors);
    double at = std::max(begin + late, wire_free_to_linux_);
    late = 0;
    for (const std::uint8_t value : record) {
        const auto copies = copies_to_linux.find(answered);
        const auto garble = garble_to_linux.find(answered);
        const auto wrong = garble == garble_to_linux.end() ? std::uint8_t{0} : garble->second;
        for (int copy = copies == copies_to_linux.end() ? 1 : copies->second; copy > 0; --copy) {
            at += kByteTime;
            to_linux_.push_back({at, static_cast<std::uint8_t>(value ^ wrong)});
        }
        ++answered;
    }
    wire_free_to_linux_ = at;
}

/// Lets everything happen up to `time`, in order, in steps small enough for the PIC's own clock.
void SimulatedLine::run_until(double time) {
    constexpr double kTick = 0.0005;
    while (time_ < time) {
        const double next_byte = to_pic_.empty() ? kNever : to_pic_.front().time;
        time_ = std::min({time, time_ + kTick, std::max(next_byte, time_)});
        if (!restarts.empty() && time_ >= restarts.front()) {
            restarts.erase(restarts.begin());
            pic.restart(time_);
        }
        while (!to_pic_.empty() && to_pic_.front().time <= time_) {
            pic.receive(to_pic_.front().time, to_pic_.front().value);
            to_pic_.pop_front();
        }
        pic.advance(time_);
        while (!pic.answers.empty()) {
            put_answer(pic.answers.front());
            pic.answers.pop_front();
        }
    }
}

void SimulatedLine::sleep_until(double time) {
    run_until(time);
}

std::size_t SimulatedLine::read(std::span<std::uint8_t> into, double until) {
    constexpr double kPoll = 0.0002;
    while ((to_linux_.empty() || to_linux_.front().time > time_) && time_ < until)
        run_until(std::min(until, time_ + kPoll));
    std::size_t count = 0;
    while (count < into.size() && !to_linux_.empty() && to_linux_.front().time <= time_) {
        into[count++] = to_linux_.front().value;
        to_linux_.pop_front();
    }
    return count;
}

void SimulatedLine::write(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t value : bytes) {
        const auto copies = copies_to_pic.find(sent);
        const auto garble = garble_to_pic.find(sent);
        const auto wrong = garble == garble_to_pic.end() ? std::uint8_t{0} : garble->second;
        for (int copy = copies == copies_to_pic.end() ? 1 : copies->second; copy > 0; --copy) {
            wire_free_to_pic_ = std::max(wire_free_to_pic_, time_) + kByteTime;
            to_pic_.push_back({wire_free_to_pic_, static_cast<std::uint8_t>(value ^ wrong)});
        }
        ++sent;
    }
}

}  // namespace puckloop::control
