#pragma once
namespace puckloop::dspic {
struct SkipLoops {};
}  // namespace puckloop::dspic
