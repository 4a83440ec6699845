#include "emu/wifi/frame_capture.h"

#include "base/files/new_file.h"

#include <algorithm>
#include <cmath>

namespace puckloop::wifi {

namespace {

constexpr cosim::Time kNanosecond = cosim::kMicrosecond / 1000;
constexpr double kWeakest = -127;  // dBm, that radiotap can have

std::ofstream new_capture(const std::string& file) {
    make_new_file(file);
    return std::ofstream(file, std::ios::binary);
}

}  // namespace

FrameCapture::FrameCapture(const std::string& file, const WifiSettings& settings,
                           std::vector<protocols::MacAddress> macs, std::size_t access_point)
    : out_(new_capture(file)),
      writer_(out_),
      interface_(writer_.interface("air", pcapng::LinkType::Radiotap)),
      macs_(std::move(macs)),
      access_point_(access_point),
      short_preamble_(settings.standard == "b" && settings.preamble == "short") {}

protocols::RadioReport FrameCapture::report_of(const Transmission& sent) const {
    double dbm = kWeakest;
    for (std::size_t station = 0; station < sent.dbm.size(); ++station)
        if (station != sent.station && (sent.hop_to == kEveryStation || sent.hop_to == station))
            dbm = std::max(dbm, sent.dbm[station]);
    return {.microseconds = static_cast<std::uint64_t>(sent.start / cosim::kMicrosecond),
            .bits = sent.rate->bits,
            .ofdm = sent.rate->symbol_bits != 0,
            .short_preamble = short_preamble_,
            .dbm = static_cast<int>(std::lround(std::min(dbm, 127.0)))};
}

void FrameCapture::add(const Transmission& sent, const Frame* frame, const protocols::MacAddress& source,
                       const protocols::MacAddress& destination) {
    constexpr std::uint64_t kSequences = 4096;
    const auto nanoseconds = static_cast<std::uint64_t>(sent.start / kNanosecond);
    const protocols::RadioReport radio = report_of(sent);
    if (frame == nullptr) {
        writer_.packet(interface_, nanoseconds, capture_ack(radio, macs_[sent.hop_to]));
        return;
    }
    const bool to_all = sent.hop_to == kEveryStation;
    const bool infrastructure = access_point_ != kEveryStation;
    // Without an access point the first station's address is the network's.
    const protocols::MacAddress network = infrastructure ? macs_[access_point_] : macs_.front();
    const protocols::DataFrame data{
        .to_access_point = infrastructure && sent.station != access_point_,
        .from_access_point = infrastructure && sent.station == access_point_,
        .again = sent.attempt > 1,
        .duration = static_cast<std::uint16_t>((sent.reserved - sent.end) / cosim::kMicrosecond),
        .transmitter = macs_[sent.station],
        .receiver = to_all ? destination : macs_[sent.hop_to],
        .source = source,
        .destination = destination,
        .network = network,
        .sequence = static_cast<std::uint16_t>(frame->number % kSequences)};
    writer_.packet(interface_, nanoseconds, capture_data(radio, data, frame->octets.view()));
}

}  // namespace puckloop::wifi
