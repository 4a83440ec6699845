#include "traces/decoders/decode.h"

#include "traces/decoders/decoders.h"

#include <fmt/format.h>

#include <memory>
#include <optional>

namespace puckloop::tools {

namespace {

/// Names of the links that have an end of a kind, found before anything is decoded.
struct Ends {
    bool xbee = false, bluetooth = false, board = false;
    std::optional<protocols::UartReceiver> setting;  ///< the first that either end shows
};

std::unique_ptr<UartDecoder> decoder_for(const Ends& ends, const TakeFrame& take) {
    if (ends.xbee) return std::make_unique<XBeeDecoder>(take);
    if (ends.bluetooth) return std::make_unique<LmxDecoder>(take);
    if (ends.board) return std::make_unique<EpuckDecoder>(take);
    return std::make_unique<BytesDecoder>(take);
}

/// One division, so that 0.05 s is written so.
double seconds(cosim::Time time) {
    return static_cast<double>(time) / static_cast<double>(cosim::kSecond);
}

}  // namespace

void decode_trace(const RecordedTrace& trace, const TakeFrame& take, const DecodeWatch& watch) {
    std::map<std::string, Ends> ends;
    TraceSelection frames = trace.selection();
    if (frames.passes_over) frames.passes_over = [](std::string_view) { return true; };
    trace.with(frames).for_each_checked([&](const cosim::TraceRow& row) {
        if (watch.first) watch.first(row);
        const auto* frame = std::get_if<cosim::UartFrame>(&row.payload);
        if (frame == nullptr) return;
        Ends& of = ends[row.link];
        if (!of.setting) of.setting = setting_of(row, *frame);
        of.xbee = of.xbee || row.from.ends_with(".xbee");
        of.bluetooth = of.bluetooth || row.link.ends_with(".bluetooth");
        // A board that never answered is known by its link's name.
        of.board = of.board || ((row.from.ends_with(".pic") || row.from.ends_with(".linux")) &&
                                row.link.ends_with(".uart"));
    });
    std::map<std::string, std::unique_ptr<UartDecoder>> uarts;
    for (const auto& [link, of] : ends) {
        uarts[link] = decoder_for(of, take);
        if (of.setting) uarts[link]->assume(*of.setting);
    }
    const FaultMarks marks(trace);
    FaultMarkCursor faults(marks);
    I2cDecoder i2c(marks, take);
    RabDecoder rab(take);
    IrcomDecoder ircom(take);
    RecordedTrace::Cursor cursor(trace);
    while (const auto row = cursor.next()) {
        if (watch.second) watch.second(*row);
        while (const FaultMark* mark = faults.next(row->time))
            decode_mark(*mark, take);
        if (const auto* frame = std::get_if<cosim::UartFrame>(&row->payload)) {
            // A link that was not there before: the file is another one now, for its run went back.
            if (const auto uart = uarts.find(row->link); uart != uarts.end()) uart->second->add(*row, *frame);
        } else if (const auto* phase = std::get_if<cosim::I2cPhase>(&row->payload))
            i2c.add(*row, *phase);
        else if (const auto* signal = std::get_if<cosim::Signal>(&row->payload))
            static_cast<void>(rab.add(*row, *signal) || ircom.add(*row, *signal));
        else if (const auto* radio = radio_on_air(*row))
            decode_radio(*row, *radio, take);
        else if (const cosim::Packet* packet = sent_packet(*row))
            decode_packet(*row, *packet, take);
        else if (const auto can = can_on_bus(*row))
            decode_can(*row, *can, take);
    }
    for (auto& [link, uart] : uarts)
        uart->end();
    i2c.end();
    rab.end();
    ircom.end();
    while (const FaultMark* mark = faults.next(cosim::kNever))
        decode_mark(*mark, take);
}

bool is_of_frames(std::string_view signal) {
    return RabDecoder::is_of_frames(signal) || IrcomDecoder::is_of_frames(signal);
}

std::string to_text(const DecodedFrame& frame) {
    std::string text = fmt::format("{} {} {} {}: {}", cosim::format_seconds(frame.begin), frame.link,
                                   frame.from, frame.protocol, frame.text);
    for (const std::string& error : frame.errors)
        text += fmt::format("  !! {}", error);
    return text;
}

std::string to_json(const DecodedFrame& frame) {
    nlohmann::ordered_json json{{"begin_s", seconds(frame.begin)},
                                {"end_s", seconds(frame.end)},
                                {"link", frame.link},
                                {"from", frame.from},
                                {"protocol", frame.protocol}};
    json.update(frame.fields);
    json["errors"] = frame.errors;
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace puckloop::tools
