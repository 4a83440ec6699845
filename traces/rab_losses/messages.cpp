#include "traces/rab_losses/messages.h"

#include "base/quantile.h"

#include <utility>

namespace puckloop::tools {

namespace {

// Registers of the board, docs/rab.md.
enum WriteRegister : std::uint8_t {
    kSetUpper = 13,
    kSendAll = 14,
    kSendEach = 15,
    kShiftUpper = 19,
    kShiftUpperToo = 20,
    kPayloadSize = 21,
};
enum ReadRegister : std::uint8_t { kPopMessage = 0, kData1 = 1, kData0 = 2, kData3 = 10, kData2 = 11 };

constexpr int kBitsOfByte = 8;
constexpr int kUsualSize = 16;
constexpr std::uint32_t kByteMask = 0xFF;

std::uint32_t low_bits(int size) {
    return size >= 32 ? ~std::uint32_t{0} : (std::uint32_t{1} << size) - 1;
}

/// Place of a data register in the payload; negative for others.
int shift_of(std::uint8_t number) {
    switch (number) {
    case kData0:
        return 0;
    case kData1:
        return kBitsOfByte;
    case kData2:
        return 2 * kBitsOfByte;
    case kData3:
        return 3 * kBitsOfByte;
    default:
        return -1;
    }
}

}  // namespace

std::vector<Send> sends_of(const std::vector<RegisterAccess>& accesses) {
    std::vector<Send> sends;
    std::uint32_t upper = 0;
    int size = kUsualSize;
    for (const RegisterAccess& access : accesses) {
        if (access.read) continue;
        switch (access.number) {
        case kSetUpper:
            upper = access.value;
            break;
        case kShiftUpper:
        case kShiftUpperToo:
            upper = upper << kBitsOfByte | access.value;
            break;
        case kPayloadSize:
            if (access.value == 8 || access.value == 16 || access.value == 24 || access.value == 32)
                size = access.value;
            break;
        case kSendAll:
            sends.push_back({access.end, (upper << kBitsOfByte | access.value) & low_bits(size)});
            break;
        case kSendEach:
            sends.push_back({access.end, {}});
            break;
        default:
            break;
        }
    }
    return sends;
}

std::vector<Poll> polls_of(const std::vector<RegisterAccess>& accesses) {
    std::vector<Poll> polls;
    for (const RegisterAccess& access : accesses) {
        if (!access.read) continue;
        if (access.number == kPopMessage) {
            polls.push_back({access.end, access.value == 1, 0, 0});
            continue;
        }
        const int shift = shift_of(access.number);
        if (shift < 0 || polls.empty() || !polls.back().message) continue;
        polls.back().payload |= std::uint32_t{access.value} << shift;
        polls.back().payload_mask |= kByteMask << shift;
    }
    return polls;
}

double poll_period(const std::vector<Poll>& polls) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < polls.size(); ++i)
        gaps.push_back(cosim::to_seconds(polls[i].time - polls[i - 1].time));
    return gaps.empty() ? 0.0 : upper_median(std::move(gaps));
}

}  // namespace puckloop::tools
