#pragma once
// What a debug adapter shows of a program that stands still, as the protocol's objects.

#include "bench/debugger/session.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace puckloop::exec::debugger {

/// Scopes and what can be opened within them are numbers (`variablesReference`).
inline constexpr int kVariablesScope = 1, kCoreScope = 2, kSpecialScope = 3, kFirstOpened = 1000;

/// Frames from `first` on, at most `count` (0: all), and how many there are.
nlohmann::json stack_trace(Session& session, std::size_t first, std::size_t count);
/// Variables, registers, or the parts of one of them.
nlohmann::json variables(Session& session, int reference);
/// The value of an expression. Throws InputError.
nlohmann::json evaluated(Session& session, const std::string& expression);
/// `count` instructions, beginning `offset` of them from `address`; those that do not exist as the protocol
/// wants it.
nlohmann::json disassembled(Session& session, std::uint32_t address, std::int64_t offset, std::int64_t count);
/// Bytes from an address of DebugChip's, as far as they exist, in base64.
nlohmann::json memory(Session& session, std::uint32_t address, std::uint32_t count);
/// Name and, where it is found, path of the source of a place.
nlohmann::json source(const Program& program, const std::string& file);

}  // namespace puckloop::exec::debugger
