#include "call.hpp"

namespace metier::urscript {
namespace {

// Default values: script manual, module motion.
constexpr double kMovejAcceleration = 1.4;  // [rad/s^2]
constexpr double kMovejVelocity = 1.05;     // [rad/s]
constexpr double kMovelAcceleration = 1.2;  // [m/s^2]
constexpr double kMovelVelocity = 0.25;     // [m/s]
constexpr double kOptimoveShare = 0.3;
constexpr double kServojTime = 0.008;  // [s]

struct Defaults {
    double acceleration;
    double velocity;
};

/// Move with the arguments `target a v t r`.
template <typename T>
Value timedMove(Call& call, Defaults defaults) {
    T move;
    move.target = call.target(0);
    move.acceleration = call.number(1, defaults.acceleration);
    move.velocity = call.number(2, defaults.velocity);
    move.time = call.number(3, 0.0);
    move.blend_radius = call.number(4, 0.0);
    return call.moves(move);
}

/// Move with the arguments `target a v r`.
template <typename T>
Value untimedMove(Call& call, Defaults defaults) {
    T move;
    move.target = call.target(0);
    move.acceleration = call.number(1, defaults.acceleration);
    move.velocity = call.number(2, defaults.velocity);
    move.blend_radius = call.number(3, 0.0);
    return call.moves(move);
}

Value movec(Call& call) {
    MoveC move;
    move.via = call.target(0);
    move.target = call.target(1);
    move.acceleration = call.number(2, kMovelAcceleration);
    move.velocity = call.number(3, kMovelVelocity);
    move.blend_radius = call.number(4, 0.0);
    move.mode = call.integer(5, 0);
    return call.moves(move);
}

Value servoj(Call& call) {
    ServoJ servo;
    servo.joint_position = call.vector6(0);
    servo.time = call.number(3, kServojTime);
    servo.lookahead_time = call.number(4, servo.lookahead_time);
    servo.gain = call.number(5, servo.gain);
    return call.moves(servo);
}

Value speedj(Call& call) {
    SpeedJ speed;
    speed.velocity = call.vector6(0);
    speed.acceleration = call.number(1, kMovejAcceleration);
    speed.time = call.number(2, 0.0);
    return call.moves(speed);
}

Value speedl(Call& call) {
    SpeedL speed;
    speed.twist = call.vector6(0);
    speed.acceleration = call.number(1, kMovelAcceleration);
    speed.time = call.number(2, 0.0);
    return call.moves(speed);
}

template <typename T>
Value stop(Call& call) {
    T stop;
    stop.acceleration = call.number(0, stop.acceleration);
    return call.moves(stop);
}

Value directTorque(Call& call) {
    DirectTorque torque;
    torque.torque = call.vector6(0);
    torque.friction_compensation = call.boolean(1, true);
    if (call.given(2)) {
        torque.viscous_scale = call.vector6(2);
    }
    if (call.given(3)) {
        torque.coulomb_scale = call.vector6(3);
    }
    return call.moves(torque);
}

}  // namespace

std::span<const Builtin> motionBuiltins() {
    static constexpr Defaults kJoint{kMovejAcceleration, kMovejVelocity};
    static constexpr Defaults kLinear{kMovelAcceleration, kMovelVelocity};
    static constexpr Defaults kShare{kOptimoveShare, kOptimoveShare};
    static constexpr Builtin kAll[] = {
        {"direct_torque", "torque friction_comp viscous_scale coulomb_scale", 1, directTorque},
        {"movec", "pose_via pose_to a v r mode", 2, movec},
        {"movej", "q a v t r", 1, [](Call& call) { return timedMove<MoveJ>(call, kJoint); }},
        {"movel", "pose a v t r", 1, [](Call& call) { return timedMove<MoveL>(call, kLinear); }},
        {"movep", "pose a v r", 1, [](Call& call) { return untimedMove<MoveP>(call, kLinear); }},
        {"optimovej", "q a v r", 1,
         [](Call& call) { return untimedMove<OptimoveJ>(call, kShare); }},
        {"optimovel", "pose a v r", 1,
         [](Call& call) { return untimedMove<OptimoveL>(call, kShare); }},
        {"servoc", "pose a v r", 1, [](Call& call) { return untimedMove<ServoC>(call, kLinear); }},
        {"servoj", "q a v t lookahead_time gain", 1, servoj},
        {"speedj", "qd a t", 1, speedj},
        {"speedl", "xd a t aRot", 1, speedl},
        {"stopj", "a", 0, stop<StopJ>},
        {"stopl", "a aRot", 0, stop<StopL>},
    };
    return kAll;
}

}  // namespace metier::urscript
