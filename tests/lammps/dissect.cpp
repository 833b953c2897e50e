#include "lammps/dissect.h"

#include <algorithm>
#include <cmath>

namespace cairn::lammps {

namespace {

Vec3 spin(const Rigid& body, const Quat& q, const Vec3& momentum) {
  return q * (q.conjugate() * momentum).cwiseQuotient(body.inertia);
}

/// Attitude after dt at rate w, to first order.
Quat advanced(const Quat& q, const Vec3& w, double dt) {
  Quat out = q;
  out.coeffs() += 0.5 * dt * (Quat(0.0, w.x(), w.y(), w.z()) * q).coeffs();
  return out.normalized();
}

Vec3 tangential(const Vec3& u, const Vec3& n) {
  return u - u.dot(n) * n;
}

}  // namespace

/// Turns a body over dt; its mean spin.
Vec3 Collision::turn(Rigid& body, double dt) const {
  if (!use_.splitting) {
    const Quat once = advanced(body.q, spin(body, body.q, body.momentum), dt);
    const Quat half = advanced(body.q, spin(body, body.q, body.momentum), 0.5 * dt);
    const Vec3 w = spin(body, half, body.momentum);
    const Quat twice = advanced(half, w, 0.5 * dt);
    body.q.coeffs() = 2.0 * twice.coeffs() - once.coeffs();
    body.q.normalize();
    return w;
  }
  Vec3 p = body.q.conjugate() * body.momentum;
  Quat turned = Quat::Identity();
  for (const auto& [axis, part] : {std::pair{0, 0.5}, {1, 0.5}, {2, 1.0}, {1, 0.5}, {0, 0.5}}) {
    const Quat flow(Eigen::AngleAxisd(part * dt * p[axis] / body.inertia[axis], Vec3::Unit(axis)));
    p = flow.conjugate() * p;
    turned = turned * flow;
  }
  const Vec3 w = body.q * (2.0 / (dt * turned.w()) * turned.vec());
  body.q = (body.q * turned).normalized();
  return w;
}

Vec3 Collision::separation(const Pair& pair) const {
  const Rigid &a = bodies_[balls_[pair.i].body], &b = bodies_[balls_[pair.j].body];
  return (b.x + pair.arm_j) - (a.x + pair.arm_i);
}

void Collision::step(double dt) {
  const auto kick = [&] {
    for (Rigid& b : bodies_) {
      b.v += 0.5 * dt / b.mass * b.force;
      b.momentum += 0.5 * dt * b.torque;
    }
  };
  const auto arms = [&] {
    std::vector<Vec3> out;
    for (const Ball& ball : balls_) out.push_back(bodies_[ball.body].q * ball.offset);
    return out;
  };
  kick();
  const std::vector<Vec3> before = arms();
  std::vector<Motion> motion;
  for (Rigid& b : bodies_) {
    Motion m;
    b.x += dt * b.v;
    m.v_mid = b.v;
    m.w_mid = turn(b, dt);
    m.v_end = b.v + 0.5 * dt / b.mass * b.force;
    m.w_end = spin(b, b.q, b.momentum + 0.5 * dt * b.torque);
    b.force.setZero();
    b.torque.setZero();
    motion.push_back(m);
  }
  const std::vector<Vec3> after = arms();
  for (std::size_t i = 0; i < balls_.size(); ++i)
    for (std::size_t j = i + 1; j < balls_.size(); ++j) {
      if (balls_[i].body == balls_[j].body) continue;
      const Pair pair{i, j, after[i], after[j], 0.5 * (before[i] + after[i]), 0.5 * (before[j] + after[j])};
      if (separation(pair).norm() < balls_[i].radius + balls_[j].radius)
        meet(pair, motion, dt);
      else if (touching_.contains({i, j}))
        part(pair, motion, dt);
    }
  kick();
}

void Collision::meet(const Pair& pair, const std::vector<Motion>& motion, double dt) {
  const Ball &i = balls_[pair.i], &j = balls_[pair.j];
  Rigid &a = bodies_[i.body], &b = bodies_[j.body];
  const Motion &ma = motion[i.body], &mb = motion[j.body];
  const double radii = i.radius + j.radius;
  const auto lever = [&](double distance, double own, double other) {
    return use_.common_point ? 0.5 * (distance + (own * own - other * other) / distance) : own;
  };
  // Velocity of j against i at the contact.
  const auto relative = [&](const Vec3& va, const Vec3& wa, const Vec3& arm_a, const Vec3& vb, const Vec3& wb,
                            const Vec3& arm_b, const Vec3& d) -> Vec3 {
    const double distance = d.norm();
    const Vec3 turning = lever(distance, i.radius, j.radius) * wa + lever(distance, j.radius, i.radius) * wb;
    return vb + wb.cross(arm_b) - va - wa.cross(arm_a) - turning.cross(d / distance);
  };

  const Vec3 d = separation(pair), n = d.normalized();
  const double overlap = radii - d.norm();
  const double lever_i = lever(d.norm(), i.radius, j.radius), lever_j = lever(d.norm(), j.radius, i.radius);
  const Vec3 u = use_.dashpots_at_end
                     ? relative(ma.v_end, ma.w_end, pair.arm_i, mb.v_end, mb.w_end, pair.arm_j, d)
                     : relative(ma.v_mid, ma.w_mid, pair.arm_i, mb.v_mid, mb.w_mid, pair.arm_j, d);
  const Vec3 centres_mid =
      mb.v_mid + mb.w_mid.cross(pair.arm_j_mid) - ma.v_mid - ma.w_mid.cross(pair.arm_i_mid);
  const Vec3 d_mid = d - 0.5 * dt * centres_mid, n_mid = d_mid.normalized();

  const auto [at, fresh] = touching_.try_emplace({pair.i, pair.j});
  Memory& memory = at->second;
  if (fresh) set_damping(pair, pair.arm_i + lever_i * n, pair.arm_j - lever_j * n, n, memory);
  double age = dt;
  if (fresh && use_.partial_steps && centres_mid.dot(n_mid) != 0.0)
    age = std::min(dt, overlap / std::abs(centres_mid.dot(n_mid)));

  const double push = law_.k_n * overlap - memory.c_n * u.dot(n);
  const Vec3 u_t = tangential(u, n);
  Vec3& slide = memory.slide;
  Vec3 friction = Vec3::Zero();
  if (law_.friction > 0.0) {
    if (use_.springs_turn) {
      const Vec3 rate = tangential(
          relative(ma.v_mid, ma.w_mid, pair.arm_i_mid, mb.v_mid, mb.w_mid, pair.arm_j_mid, d_mid), n_mid);
      const Vec3 mean = 0.5 * (ma.w_mid + mb.w_mid);
      const double half = std::atan(0.5 * age * mean.norm());  // w_mid is (2 / dt) tan(angle / 2)
      const Quat turned(Eigen::AngleAxisd(half, mean.norm() > 0.0 ? mean.normalized() : Vec3::UnitX()));
      slide = turned * (turned * slide + age * rate);
      const double length = slide.norm();
      slide = tangential(slide, n);
      if (slide.norm() > 0.0) slide *= length / slide.norm();
    } else {
      const Vec3 rate =
          tangential(relative(ma.v_mid, ma.w_mid, pair.arm_i, mb.v_mid, mb.w_mid, pair.arm_j, d), n);
      slide = tangential(slide + age * rate, n);
    }
    if (use_.spring_cut_first) {
      const double limit = law_.friction * std::max(push, 0.0);
      if (law_.k_s * slide.norm() > limit) slide *= limit / (law_.k_s * slide.norm());
      friction = law_.k_s * slide + memory.c_s * u_t;
      if (friction.norm() > limit) friction *= limit / friction.norm();
    } else {
      const double limit = law_.friction * std::abs(push);
      friction = law_.k_s * slide + memory.c_s * u_t;
      if (friction.norm() > limit) {
        friction *= limit / friction.norm();
        slide = (friction - memory.c_s * u_t) / law_.k_s;
      }
    }
  }

  const Vec3 force = friction - push * n;  // on i
  const Vec3 couple_i = lever_i * n.cross(force), couple_j = lever_j * n.cross(force);
  a.force += force;
  b.force -= force;
  a.torque += pair.arm_i.cross(force) + couple_i;
  b.torque -= pair.arm_j.cross(force) - couple_j;
  // The kicks at both ends of the step give the force dt / 2 each way; it has acted for `age`, and its spring
  // has grown from nothing meanwhile.
  if (fresh && use_.partial_steps) {
    const double due = age - 0.5 * dt;
    impulse(pair, due * force + 0.5 * age * law_.k_n * overlap * n, due * couple_i, due * couple_j);
  }
}

void Collision::part(const Pair& pair, const std::vector<Motion>& motion, double dt) {
  const Ball &i = balls_[pair.i], &j = balls_[pair.j];
  const Motion &ma = motion[i.body], &mb = motion[j.body];
  const Memory memory = touching_.at({pair.i, pair.j});
  touching_.erase({pair.i, pair.j});
  if (!use_.partial_steps) return;
  const Vec3 d = separation(pair), n = d.normalized();
  const double gap = d.norm() - i.radius - j.radius;
  const double u_n =
      (mb.v_mid + mb.w_mid.cross(pair.arm_j_mid) - ma.v_mid - ma.w_mid.cross(pair.arm_i_mid)).dot(n);
  if (!(u_n > 0.0)) return;
  const double absent = std::min(dt, gap / u_n), present = dt - absent;
  const double due = (present - 0.5 * dt) * memory.c_n * u_n + 0.5 * law_.k_n * u_n * present * absent;
  impulse(pair, due * n, Vec3::Zero(), Vec3::Zero());
}

void Collision::impulse(const Pair& pair, const Vec3& on_i, const Vec3& couple_i, const Vec3& couple_j) {
  Rigid &a = bodies_[balls_[pair.i].body], &b = bodies_[balls_[pair.j].body];
  a.v += on_i / a.mass;
  b.v -= on_i / b.mass;
  a.momentum += pair.arm_i.cross(on_i) + couple_i;
  b.momentum -= pair.arm_j.cross(on_i) - couple_j;
}

void Collision::set_damping(const Pair& pair, const Vec3& point_i, const Vec3& point_j, const Vec3& n,
                            Memory& memory) const {
  memory.c_n = law_.c_n;
  memory.c_s = law_.c_s;
  if (!use_.mass_at_contact) return;
  // Velocity that a unit force along e gives the contact point, along e.
  const auto mobility = [&](const Vec3& e) {
    double sum = 0.0;
    for (const auto& [b, point] : {std::pair{balls_[pair.i].body, point_i}, {balls_[pair.j].body, point_j}}) {
      const Rigid& body = bodies_[b];
      const Vec3 moment = point.cross(e);
      sum += 1.0 / body.mass + moment.dot(spin(body, body.q, moment));
    }
    return sum;
  };
  const Vec3 e = n.unitOrthogonal();
  memory.c_n *= std::sqrt(law_.k_n / mobility(n));
  memory.c_s *= std::sqrt(law_.k_s * 2.0 / (mobility(e) + mobility(n.cross(e))));
}

}  // namespace cairn::lammps
