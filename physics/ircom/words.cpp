#include "physics/ircom/words.h"

#include "base/json.h"
#include <fmt/format.h>

#include <algorithm>

namespace puckloop::physics {

using cosim::Time;
using protocols::IrcomReader;
using protocols::IrcomReading;

namespace {
constexpr int kFewestEdges = 20;
constexpr double kSeenOfOther = 1.0;  // counts: what another's word must have to overlap one
}  // namespace

IrcomWords::IrcomWords(const IrcomMedium& medium, const std::string& file) : medium_(medium) {
    const std::size_t devices = medium.scene().device_count();
    senders_.resize(devices);
    for (Sender& sender : senders_) {
        sender.brightest.resize(devices);
        sender.with.resize(devices);
    }
    if (!file.empty())
        csv_ = std::make_unique<CsvFile>(
            file, "t_s,end_s,sender,word,fault,receiver,counts,overlap,receiver_sending");
}

void IrcomWords::edge(Time now, std::size_t device, bool lit) {
    close_until(now);
    Sender& sender = senders_[device];
    if (sender.last < 0) {
        std::fill(sender.brightest.begin(), sender.brightest.end(), 0.0);
        std::fill(sender.with.begin(), sender.with.end(), std::uint8_t{0});
        sender.edges = 0;
    }
    sender.last = now;
    ++sender.edges;
    (void)sender.reader.edge(now, lit);  // close_until() has taken what ended
    for (std::size_t other = 0; other < senders_.size(); ++other) {
        if (other == device) continue;
        if (senders_[other].last < 0) continue;
        sender.with[other] = senders_[other].with[device] = 1;
    }
}

void IrcomWords::seen(std::size_t device) {
    std::vector<double>& brightest = senders_[device].brightest;
    for (std::size_t other = 0; other < senders_.size(); ++other)
        if (other != device) brightest[other] = std::max(brightest[other], medium_.from(device, other));
}

void IrcomWords::close_until(Time now) {
    // In the order in which they ended, whatever the times at which this is called.
    for (;;) {
        std::size_t first = senders_.size();
        for (std::size_t d = 0; d < senders_.size(); ++d)
            if (senders_[d].last >= 0 && now - senders_[d].last >= IrcomReader::kRest &&
                (first == senders_.size() || senders_[d].last < senders_[first].last))
                first = d;
        if (first == senders_.size()) return;
        senders_[first].last = -1;
        if (const auto reading = senders_[first].reader.until(now)) close(first, *reading);
    }
}

void IrcomWords::close(std::size_t device, const IrcomReading& reading) {
    Sender& sender = senders_[device];
    if (!reading.ok() && reading.edges < kFewestEdges) {
        ++sender.flashes;
        return;
    }
    ++(reading.ok() ? sender.words : sender.faulty);
    if (csv_) write(device, reading);
}

void IrcomWords::write(std::size_t device, const IrcomReading& reading) {
    const Sender& sender = senders_[device];
    const IrcomScene& scene = medium_.scene();
    const bool readable = reading.ok() || reading.fault == protocols::IrcomFault::Check;
    const std::string head =
        fmt::format("{:.9f},{:.9f},{},{},{}", cosim::to_seconds(reading.start),
                    cosim::to_seconds(reading.end), scene.name(device),
                    readable ? fmt::format("{:02X}", reading.word) : "", protocols::name_of(reading.fault));
    bool reached = false;
    for (std::size_t r = 0; r < senders_.size(); ++r) {
        if (sender.brightest[r] <= 0.0) continue;
        reached = true;
        bool overlap = false;
        for (std::size_t other = 0; other < senders_.size(); ++other)
            overlap |= other != r && sender.with[other] != 0 && senders_[other].edges > 2 &&
                       senders_[other].brightest[r] >= kSeenOfOther;
        csv_->row(fmt::format("{},{},{:.1f},{},{}", head, scene.name(r), sender.brightest[r], overlap ? 1 : 0,
                              sender.with[r] != 0 && senders_[r].edges > 2 ? 1 : 0));
    }
    if (!reached) csv_->row(head + ",,0.0,0,0");
}

std::string IrcomWords::finish() {
    Time end = 0;
    for (const Sender& sender : senders_)
        end = std::max(end, sender.last);
    close_until(end + IrcomReader::kRest);
    if (csv_) csv_->flush();
    auto report = nlohmann::ordered_json::array();
    for (std::size_t d = 0; d < senders_.size(); ++d)
        report.push_back({{"device", medium_.scene().name(d)},
                          {"words", senders_[d].words},
                          {"unreadable_words", senders_[d].faulty},
                          {"flashes", senders_[d].flashes}});
    return report.dump();
}

}  // namespace puckloop::physics
