#include "thread.hpp"

#include <fmt/format.h>

#include <utility>

#include "operators.hpp"

namespace metier::urscript {
namespace {

constexpr std::size_t kLargestStack = 20'000;  // largest number of values on the stack of a thread

Result<void> spend(ThreadContext& context, std::size_t instructions) {
    if (context.spend(instructions)) {
        return {};
    }
    return fail(Errc::timeout,
                fmt::format("infinite loop: more than {} instructions in one cycle, without sync()",
                            context.limits().instructions_per_cycle));
}

Result<void> checkSize(const Value& value, ThreadContext& context) {
    const RunLimits& limits = context.limits();
    const List* list = value.get<List>();
    if (list != nullptr && list->weight() > limits.list_length) {
        return fail(Errc::out_of_range,
                    fmt::format("a list of more than {} values", limits.list_length));
    }
    if (list != nullptr && list->characters() > limits.text_length) {
        return fail(Errc::out_of_range,
                    fmt::format("a list with more than {} characters", limits.text_length));
    }
    const auto* text = value.get<std::string>();
    if (text != nullptr && text->size() > limits.text_length) {
        return fail(Errc::out_of_range,
                    fmt::format("a string of more than {} characters", limits.text_length));
    }
    return list == nullptr && text == nullptr ? Result<void>() : spend(context, costOf(value));
}

/// A thread's handle; 0 for any number that is none, as scripts initialise theirs.
Result<std::int32_t> handleOf(const Value& value) {
    if (!value.isNumber()) {
        return fail(Errc::type_mismatch,
                    fmt::format("a thread's handle is an int, not {}", value.typeName()));
    }
    const auto* handle = value.get<std::int32_t>();
    return handle == nullptr ? 0 : *handle;
}

}  // namespace

Thread::Thread(std::int32_t handle, const Code& code, std::size_t function)
    : handle_(handle),
      code_(code),
      frames_{{&code.functions[function], 0, 0}},
      stack_(code.functions[function].locals.size()) {}

Thread::State Thread::step(ThreadContext& context) {
    if (state_ != State::ready) {
        return state_;
    }
    auto done = resume(context);
    while (done && state_ == State::ready && !wait_) {
        Frame& frame = frames_.back();
        const Instruction& instruction = frame.function->instructions[frame.next];
        ++frame.next;
        at_ = instruction.at;
        done = spend(context, 1);
        if (done) {
            done = execute(instruction, context);
        }
    }
    if (!done) {
        error_ = std::move(done.error());
        state_ = State::failed;
    }
    return state_;
}

/// Ends a wait if what it waits for has come.
Result<void> Thread::resume(ThreadContext& context) {
    if (!wait_) {
        return {};
    }
    METIER_ASSIGN(auto came, wait_());
    if (!came) {
        return {};
    }
    wait_ = nullptr;
    return push(*std::move(came), context);
}

Result<void> Thread::execute(const Instruction& instruction, ThreadContext& context) {
    const auto a = static_cast<std::size_t>(instruction.a);
    switch (instruction.op) {
        case Op::constant:
            return push(code_.constants[a], context);
        case Op::load_global:
            return load(context.globals()[a], code_.globals[a], context);
        case Op::load_local:
            return load(local(instruction.a), frames_.back().function->locals[a], context);
        case Op::store_global:
            context.globals()[a] = pop();
            return {};
        case Op::store_local:
            local(instruction.a) = pop();
            return {};
        case Op::jump:
            frames_.back().next = a;
            return {};
        case Op::jump_if_false:
            return jumpIfFalse(instruction);
        case Op::jump_if_given:
            frames_.back().next = local(instruction.n).isNone() ? frames_.back().next : a;
            return {};
        case Op::call:
            return call(code_.calls[a], context);
        case Op::call_builtin:
            return callBuiltin(code_.builtin_calls[a], context);
        case Op::pop:
            stack_.pop_back();
            return {};
        case Op::give_back:
            giveBack();
            return {};
        default:
            return executeRare(instruction, context);
    }
}

Result<void> Thread::executeRare(const Instruction& instruction, ThreadContext& context) {
    const auto a = static_cast<std::size_t>(instruction.a);
    switch (instruction.op) {
        case Op::element:
            return element(instruction.n, context);
        case Op::set_global_element:
            return setElement(context.globals()[a], instruction.n, context);
        case Op::set_local_element:
            return setElement(local(instruction.a), instruction.n, context);
        case Op::make_list:
            return makeList(a, context);
        case Op::make_pose:
            return makePose();
        case Op::negate:
            return push(negated(pop()), context);
        case Op::logical_not:
            return push(truthOf(pop()).map([](bool truth) { return Value(!truth); }), context);
        case Op::truth:
            return push(truthOf(pop()).map([](bool truth) { return Value(truth); }), context);
        case Op::run:
            return push(context.startThread(a).map([](auto handle) { return Value(handle); }),
                        context);
        case Op::kill:
            return handleOf(pop()).map([&](std::int32_t handle) {
                stack_.emplace_back();
                context.killThread(handle);
            });
        case Op::join:
            return join(context);
        case Op::halt:
            state_ = State::halted;
            return {};
        default:
            return binary(instruction.op, context);
    }
}

Result<void> Thread::load(const Value& value, std::string_view name, ThreadContext& context) {
    if (value.isNone()) {
        return fail(Errc::invalid_state, fmt::format("variable '{}' has no value", name));
    }
    stack_.push_back(value);  // may invalidate `value`: a local variable is on the stack, too
    const auto& loaded = stack_.back();
    // Lists are shared, text is copied.
    return loaded.get<std::string>() == nullptr ? Result<void>() : checkSize(loaded, context);
}

Result<void> Thread::binary(Op op, ThreadContext& context) {
    const Value right = pop();
    const Value left = pop();
    METIER_TRY(spend(context, costOf(left) + costOf(right)));
    return push(applyBinary(op, left, right), context);
}

Result<void> Thread::element(std::size_t indices, ThreadContext& context) {
    const std::size_t base = stack_.size() - indices;
    auto found = elementOf(stack_[base - 1], std::span(stack_).subspan(base));
    stack_.resize(base - 1);
    return push(std::move(found), context);
}

Result<void> Thread::setElement(Value& target, std::size_t indices, ThreadContext& context) {
    Value value = pop();
    const std::size_t base = stack_.size() - indices;
    auto set = urscript::setElement(target, std::span(stack_).subspan(base), std::move(value));
    stack_.resize(base);
    return set ? checkSize(target, context) : set;
}

Result<void> Thread::makeList(std::size_t count, ThreadContext& context) {
    const auto first = stack_.end() - static_cast<std::ptrdiff_t>(count);
    std::vector<Value> elements(std::make_move_iterator(first),
                                std::make_move_iterator(stack_.end()));
    stack_.erase(first, stack_.end());
    return push(listOf(std::move(elements)), context);
}

Result<void> Thread::makePose() {
    const std::size_t base = stack_.size() - std::tuple_size_v<Vector6>;
    auto pose = poseOf(std::span(stack_).subspan(base));
    stack_.resize(base);
    return std::move(pose).map([&](Value value) { stack_.push_back(std::move(value)); });
}

Result<void> Thread::jumpIfFalse(const Instruction& instruction) {
    return truthOf(pop()).map([&](bool truth) {
        frames_.back().next = truth ? frames_.back().next : static_cast<std::size_t>(instruction.a);
    });
}

Result<void> Thread::call(const FunctionCall& call, ThreadContext& context) {
    const Function& function = code_.functions[call.function];
    const std::size_t base = stack_.size() - call.parameter.size();
    if (frames_.size() >= context.limits().call_depth ||
        base + function.locals.size() > kLargestStack) {
        return fail(Errc::out_of_range,
                    fmt::format("more than {} calls within each other", frames_.size()));
    }
    arrange(call.parameter, function.locals.size());
    frames_.push_back({&function, 0, base});
    return {};
}

Result<void> Thread::callBuiltin(const BuiltinCall& call, ThreadContext& context) {
    const std::size_t base = stack_.size() - call.parameter.size();
    arrange(call.parameter, call.total);
    Call made(*call.builtin, std::span(stack_).subspan(base), context);
    Value value = call.builtin->function(made);
    stack_.resize(base);
    if (!made.ok()) {
        return fail(*made.error());
    }
    if (Wait wait = made.takeWait()) {
        return waitFor(std::move(wait), context);
    }
    return push(std::move(value), context);
}

Result<void> Thread::join(ThreadContext& context) {
    METIER_ASSIGN(const auto handle, handleOf(pop()));
    if (!context.isAlive(handle)) {
        stack_.emplace_back();
        return {};
    }
    return waitFor(
        [&context, wanted = handle] {
            return Result<std::optional<Value>>(context.isAlive(wanted) ? std::optional<Value>()
                                                                        : Value());
        },
        context);
}

Result<void> Thread::waitFor(Wait wait, const ThreadContext& context) {
    if (!context.mayWait()) {
        return fail(Errc::not_supported, "a secondary program may not call what takes time");
    }
    wait_ = std::move(wait);
    return {};
}

void Thread::giveBack() {
    Value value = pop();
    stack_.resize(frames_.back().base);
    frames_.pop_back();
    if (frames_.empty()) {
        state_ = State::ended;
    } else {
        stack_.push_back(std::move(value));
    }
}

/// Puts the arguments on top of the stack where their parameters are, and makes room for `total`.
void Thread::arrange(const std::vector<std::uint8_t>& parameter, std::size_t total) {
    const std::size_t base = stack_.size() - parameter.size();
    bool in_order = true;
    for (std::size_t i = 0; i < parameter.size(); ++i) {
        in_order = in_order && parameter[i] == i;
    }
    if (in_order) {
        stack_.resize(base + total);
        return;
    }
    const auto first = stack_.begin() + static_cast<std::ptrdiff_t>(base);
    std::vector<Value> written(std::make_move_iterator(first),
                               std::make_move_iterator(stack_.end()));
    stack_.resize(base);
    stack_.resize(base + total);
    for (std::size_t i = 0; i < parameter.size(); ++i) {
        stack_[base + parameter[i]] = std::move(written[i]);
    }
}

Result<void> Thread::push(Result<Value> value, ThreadContext& context) {
    if (!value) {
        return fail(std::move(value.error()));
    }
    auto checked = checkSize(*value, context);
    stack_.push_back(*std::move(value));
    return checked;
}

Value Thread::pop() {
    Value value = std::move(stack_.back());
    stack_.pop_back();
    return value;
}

Value& Thread::local(std::int32_t index) {
    return stack_[frames_.back().base + static_cast<std::size_t>(index)];
}

}  // namespace metier::urscript
