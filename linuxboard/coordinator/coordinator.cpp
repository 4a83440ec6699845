#include "linuxboard/coordinator/coordinator.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <tuple>
#include <utility>

namespace puckloop::coordinator {

using namespace protocols;

namespace {

constexpr double kStrengthEvery = 60;     // s between two DB
constexpr double kBehindStrength = 0.01;  // s from a DB to the ND
constexpr double kDiscoveryMargin = 1.0;  // s behind the window in which modules answer
constexpr std::size_t kWindow = 3;        // frames the module is busy with at once
constexpr double kFlightTimeout = 2.0;    // s: the module will not report on it any more
constexpr double kLastWords = 2.0;        // s for TAMs to be switched off
constexpr std::size_t kMostStrangers = 64;
constexpr std::size_t kNameAt = 10;  // in the value of ND: behind a 16-bit and a 64-bit address

std::string hex(std::uint64_t address) {
    return fmt::format("{:016X}", address);
}

/// "TAM" and two digits.
bool is_tam(std::string_view name) {
    constexpr std::string_view kPrefix = "TAM";
    return name.size() == kPrefix.size() + 2 && name.starts_with(kPrefix) &&
           std::all_of(name.begin() + kPrefix.size(), name.end(),
                       [](char c) { return c >= '0' && c <= '9'; });
}

/// Puts `address` on the list if it is not there; false if it is, or the list is full.
bool first_time(std::vector<std::uint64_t>& list, std::uint64_t address) {
    if (list.size() >= kMostStrangers || std::find(list.begin(), list.end(), address) != list.end())
        return false;
    list.push_back(address);
    return true;
}

}  // namespace

std::string_view name_of(Activity activity) {
    switch (activity) {
    case Activity::Closed:
        return "closed";
    case Activity::Free:
        return "free";
    case Activity::Working:
        return "working";
    case Activity::Done:
        return "done";
    case Activity::Pause:
        return "pause";
    }
    return "?";
}

Coordinator::Coordinator(control::Transport& line, Experiment& experiment, EventLog& log, Settings settings,
                         std::function<bool()> ended)
    : experiment_(experiment),
      log_(log),
      settings_(std::move(settings)),
      ended_(std::move(ended)),
      module_(
          line, [this](const XBeeMessage& message) { take(message); },
          [this](const std::string& fault) {
              // Endless garbage is noted at powers of two.
              if (std::has_single_bit(module_.counters().faults))
                  note("line", std::to_string(module_.counters().faults), fault);
          }),
      begun_(line.now()) {}

void Coordinator::note(const std::string& event, const std::string& value, const std::string& detail) {
    log_.add({now(), "", event, value, detail});
}

void Coordinator::run() {
    if (!start_up()) {
        note("ended", "signal");
        return;
    }
    const double begun = now();
    next_discovery_ = begun + kBehindStrength;
    next_strength_ = begun;
    note("experiment", "begins");
    const auto over = [&] { return settings_.duration > 0 && now() - begun >= settings_.duration; };
    while (!ended_() && !over() && !experiment_.finished())
        work();
    const char* reason = ended_() ? "signal" : over() ? "duration" : "finished";
    note("experiment", "ends", reason);
    switch_off();
    note("ended", reason);
}

/// One step: what comes in until it is due, then all that is to be done.
void Coordinator::work() {
    listen();
    ask_periodically();
    step_controllers();
    send_wishes();
}

/// What comes in until the next step is due; steps that are missed are left out.
void Coordinator::listen() {
    steps_ = std::max(steps_ + 1, std::floor(now() / kStep));
    module_.listen(begun_ + steps_ * kStep);
}

void Coordinator::ask_periodically() {
    const double time = now();
    if (time >= next_strength_) {
        next_strength_ = time + kStrengthEvery;
        module_.send(XBeeAt{.command = command_of("DB"), .value = {}});
    } else if (time >= next_discovery_) {
        next_discovery_ = time + settings_.discover_every;
        earliest_discovery_ = time + window_ + kDiscoveryMargin;
        note("discovery", fmt::format("{:g}", window_), "s");
        module_.send(XBeeAt{.command = command_of("ND"), .value = {}});
    }
}

void Coordinator::step_controllers() {
    experiment_.step(now());
    for (Booth& booth : booths_) {
        booth.tam->pass_time(now());
        if (!booth.controller || !booth.tam->report()) continue;
        booth.controller->step(now());
        const State state = booth.controller->state();
        if (booth.shown && state == booth.state) continue;
        booth.state = state;
        booth.shown = true;
        booth.tam->note("state", state.name, std::string(name_of(state.activity)));
    }
}

void Coordinator::send_wishes() {
    const double time = now();
    std::erase_if(flights_, [&](const Flight& flight) { return time - flight.since >= kFlightTimeout; });
    for (std::size_t looked = 0; looked < booths_.size() && flights_.size() < kWindow; ++looked) {
        Tam& tam = *booths_[turn_++ % booths_.size()].tam;
        const std::optional<XBeeBytes> payload = tam.next_request(time);
        if (!payload) continue;
        last_id_ = static_cast<std::uint8_t>(last_id_ == 0xFF ? 1 : last_id_ + 1);
        module_.send(XBeeTx{.id = last_id_, .to = tam.address(), .data = *payload});
        flights_.push_back({last_id_, &tam, time});
        tam.sent(*payload, last_id_, time);
    }
}

void Coordinator::switch_off() {
    for (Booth& booth : booths_) {
        booth.tam->set_leds(kOff);
        booth.tam->confirm_leds();
    }
    const auto work_until = [&](double time, auto&& left) {
        while (now() < time && std::any_of(booths_.begin(), booths_.end(), left)) {
            listen();
            for (Booth& booth : booths_)
                booth.tam->pass_time(now());
            send_wishes();
        }
    };
    work_until(now() + settings_.end_wait,
               [](const Booth& booth) { return !booth.tam->lost() && !booth.tam->settled(); });
    for (Booth& booth : booths_)
        if (!booth.tam->settled()) booth.tam->note("warning", "leds", "not confirmed to be off");
    if (!settings_.shut_down) return;
    for (Booth& booth : booths_)
        booth.tam->shut_down();
    work_until(now() + kLastWords, [this](const Booth& booth) {
        return !flights_.empty() || booth.tam->next_request(now()).has_value();
    });
}

void Coordinator::take(const XBeeMessage& message) {
    if (const auto* response = std::get_if<XBeeAtResponse>(&message)) {
        if (response->command == command_of("ND")) take_found(*response);
        if (response->command == command_of("DB") && !failed(*response) && !response->value.empty())
            note("strength", std::to_string(-int{response->value.back()}), "dBm");
    } else if (const auto* data = std::get_if<XBeeRx>(&message)) {
        take_data(*data);
    } else if (const auto* status = std::get_if<XBeeTxStatus>(&message)) {
        const auto flight = std::find_if(flights_.begin(), flights_.end(),
                                         [&](const Flight& f) { return f.id == status->id; });
        if (flight == flights_.end()) return;
        Tam& tam = *flight->tam;
        flights_.erase(flight);
        tam.take_status(status->id, status->delivery, now());
    } else if (const auto* modem = std::get_if<XBeeModemStatus>(&message)) {
        note("module", "status", std::to_string(modem->status));
        flights_.clear();
    }
}

void Coordinator::take_found(const XBeeAtResponse& response) {
    const XBeeBytes& value = response.value;
    if (failed(response) || value.size() <= kNameAt) return;  // the end of a discovery, or an error
    std::uint64_t address = 0;
    for (std::size_t i = 2; i < kNameAt; ++i)
        address = address << 8 | value[i];
    const auto end = std::find(value.begin() + kNameAt, value.end(), 0);
    const std::string name(value.begin() + kNameAt, end);
    if (is_tam(name))
        add(name, address);
    else if (first_time(ignored_, address))
        note("ignored", hex(address), fmt::format("'{}' is not called TAM and two digits", name));
}

void Coordinator::add(const std::string& name, std::uint64_t address) {
    if (at(address) != nullptr) return;
    const auto same = std::find_if(booths_.begin(), booths_.end(),
                                   [&](const Booth& booth) { return booth.tam->name() == name; });
    if (same != booths_.end()) {
        if (same->tam->lost()) {
            same->tam->move_to(address);
            same->tam->note("discovered", hex(address), "instead of the one that was lost");
        } else if (first_time(ignored_, address)) {
            note("ignored", hex(address), fmt::format("a second {}", name));
        }
        return;
    }
    const auto log = [this, name](const std::string& event, const std::string& value,
                                  const std::string& detail) {
        log_.add({now(), name, event, value, detail});
    };
    Booth booth{std::make_unique<Tam>(name, address, log), nullptr, {}, false};
    booth.tam->note("discovered", hex(address));
    booth.tam->set_leds(kOff);  // its answer is the first report
    booth.controller = experiment_.attach(*booth.tam);
    booths_.push_back(std::move(booth));
    std::erase(unnamed_, address);
}

void Coordinator::take_data(const XBeeRx& data) {
    const std::optional<Report> report = parse_report(data.data);
    Booth* booth = at(data.from);
    if (!report) {
        if (booth == nullptr) return;
        booth->tam->note("warning", "payload", fmt::format("{:02x}", fmt::join(data.data, " ")));
        return;
    }
    if (booth != nullptr) {
        booth->tam->take_report(*report, now());
        return;
    }
    if (first_time(unnamed_, data.from)) note("unknown", hex(data.from), "reports and has no name yet");
    next_discovery_ = std::min(next_discovery_, std::max(earliest_discovery_, now()));
}

Coordinator::Booth* Coordinator::at(std::uint64_t address) {
    for (Booth& booth : booths_)
        if (booth.tam->address() == address) return &booth;
    return nullptr;
}

}  // namespace puckloop::coordinator
