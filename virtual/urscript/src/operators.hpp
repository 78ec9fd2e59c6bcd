#pragma once

#include <span>

#include "code.hpp"
#include "metier/base/error.hpp"
#include "metier/urscript/value.hpp"

namespace metier::urscript {

// Operators on values. Errors: type_mismatch, out_of_range, invalid_argument; without position.
// Pure. Source: script manual, "Matrix and Array Expressions".

/// \param op one of Op::add to Op::logical_xor
Result<Value> applyBinary(Op op, const Value& left, const Value& right);
Result<Value> negated(const Value& value);
/// Truth of a value: a bool itself; numbers are true if not 0, strings if not empty.
Result<bool> truthOf(const Value& value);

Result<Value> elementOf(const Value& value, std::span<const Value> indices);
Result<void> setElement(Value& target, std::span<const Value> indices, Value value);

/// A list, if it is not nested too deeply. Errors: out_of_range.
Result<Value> listOf(std::vector<Value> elements);
/// A pose of 6 numbers.
Result<Value> poseOf(std::span<const Value> elements);

/// Cost of copying or making a value, in instructions; 0 for small ones.
std::size_t costOf(const Value& value);

}  // namespace metier::urscript
