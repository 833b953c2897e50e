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

/// At most `limit` long.
Vec3 cut(const Vec3& v, double limit) {
  return v.norm() > limit ? Vec3(limit / v.norm() * v) : v;
}

/// `slide` made tangential at unchanged length.
Vec3 laid_flat(const Vec3& slide, const Vec3& n) {
  const Vec3 flat = tangential(slide, n);
  return flat.norm() > 0.0 ? Vec3(slide.norm() / flat.norm() * flat) : flat;
}

/// The spring after the slider has shortened it: one at its limit turns towards the rate meanwhile.
Vec3 shortened(const Vec3& stretch, double most, const Vec3& rate, double dt) {
  if (!(stretch.norm() > most)) return stretch;
  const double over = 1.0 - most / stretch.norm();
  if (over <= 1e-6) return cut(stretch, most);
  return cut(stretch + 0.5 * over * (1.0 + over + over * over) * dt * rate, most);
}

/// Speed of separation over a way that begins at one speed and on which an energy is gained beside what the
/// dashpot takes: the mean of the speeds at both ends, which makes impulse times mean speed the work done.
double mean_speed(double mass, double c_n, double speed, double way, double gain) {
  const double free = 2.0 * mass * speed - c_n * way, square = free * free + 8.0 * mass * gain;
  return square >= 0.0 ? std::max(0.0, 0.25 * (free + std::sqrt(square)) / mass) : 0.0;
}

/// Energy of the spring as leapfrog keeps it, and the ratio of speeds outside and inside the contact.
double held_energy(double mass, double k_n, double overlap, double dt) {
  return 0.5 * k_n * overlap * overlap * (1.0 - 0.25 * dt * dt * k_n / mass);
}
double speed_ratio(double mass, double k_n, double dt) {
  return std::sqrt(1.0 + dt * dt * k_n / (6.0 * mass));
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
  const Vec3 point_i = pair.arm_i + lever_i * n, point_j = pair.arm_j - lever_j * n;
  if (fresh) set_damping(pair, point_i, point_j, n, memory);
  double age = dt;
  if (fresh && use_.partial_steps && centres_mid.dot(n_mid) < 0.0)
    age = std::min(dt, -overlap / centres_mid.dot(n_mid));

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
      slide = laid_flat(turned * (turned * slide + age * rate), n);
    } else {
      const Vec3 rate =
          tangential(relative(ma.v_mid, ma.w_mid, pair.arm_i, mb.v_mid, mb.w_mid, pair.arm_j, d), n);
      slide = tangential(slide + age * rate, n);
    }
    if (use_.spring_cut_first) {
      const double limit = law_.friction * std::max(push, 0.0);
      const Vec3 along = tangential(
          relative(ma.v_mid, ma.w_mid, pair.arm_i_mid, mb.v_mid, mb.w_mid, pair.arm_j_mid, d_mid), n_mid);
      slide = shortened(slide, limit / law_.k_s, tangential(along, n), age);
      friction = cut(law_.k_s * slide + memory.c_s * u_t, limit);
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
  if (!fresh || !use_.partial_steps || age >= dt) return;
  // Normal: what brings the speed from that of the flight to that of the contact. In the plane: trapezoids
  // over the time for which the surfaces have touched, beside the half kick that follows.
  const double mass = 1.0 / mobility(pair, point_i, point_j, n), speed = -u.dot(n);
  const double within = speed / speed_ratio(mass, law_.k_n, dt);
  const double mean =
      mean_speed(mass, memory.c_n, within, overlap, -held_energy(mass, law_.k_n, overlap, dt));
  const double normal = mean > 0.0 ? mass * (2.0 * mean - within - speed) : -0.5 * dt * push;
  const Vec3 u_mid = relative(ma.v_mid, ma.w_mid, pair.arm_i_mid, mb.v_mid, mb.w_mid, pair.arm_j_mid, d_mid);
  const Vec3 met = law_.friction > 0.0 ? cut(memory.c_s * tangential(u_mid, n),
                                             law_.friction * std::max(0.0, -memory.c_n * u_mid.dot(n)))
                                       : Vec3(Vec3::Zero());
  const Vec3 due = (normal + 0.5 * dt * push) * n + 0.5 * age * met + 0.5 * (age - dt) * friction;
  impulse(pair, due, lever_i * n.cross(due), lever_j * n.cross(due));
}

void Collision::part(const Pair& pair, const std::vector<Motion>& motion, double dt) {
  const Ball &i = balls_[pair.i], &j = balls_[pair.j];
  const Motion &ma = motion[i.body], &mb = motion[j.body];
  const Memory memory = touching_.at({pair.i, pair.j});
  touching_.erase({pair.i, pair.j});
  if (!use_.partial_steps) return;
  const Vec3 centres_mid =
      mb.v_mid + mb.w_mid.cross(pair.arm_j_mid) - ma.v_mid - ma.w_mid.cross(pair.arm_i_mid);
  const Vec3 centres_end = mb.v_end + mb.w_end.cross(pair.arm_j) - ma.v_end - ma.w_end.cross(pair.arm_i);
  const Vec3 d = separation(pair), n = d.normalized(), d_start = d - dt * centres_mid,
             n_start = d_start.normalized();
  const double radii = i.radius + j.radius, gap = d.norm() - radii, overlap = radii - d_start.norm();
  if (!(overlap > 0.0)) return;
  const double lever_i = 0.5 * (d.norm() + (i.radius * i.radius - j.radius * j.radius) / d.norm()),
               lever_j = d.norm() - lever_i;
  const double mass = 1.0 / mobility(pair, pair.arm_i + lever_i * n, pair.arm_j - lever_j * n, n);
  const double present = overlap / (overlap + gap) * dt;

  // Normal: from the speed of the contact to that of the flight.
  const double start = (2.0 * centres_mid - centres_end).dot(n_start), mid = centres_mid.dot(n_start),
               end = centres_mid.dot(n);
  const double mean = mean_speed(mass, memory.c_n, start, overlap, held_energy(mass, law_.k_n, overlap, dt));
  double after = speed_ratio(mass, law_.k_n, dt) * (2.0 * mean - start);
  if (!(mean > 0.0 && after > 0.0))
    after = start + present / mass * (0.5 * law_.k_n * overlap - memory.c_n * start);
  const double given = 0.5 * dt / mass * (law_.k_n * overlap - memory.c_n * start);
  const double right = mid - given + after - start, square = end * end + right * right - mid * mid;
  const double change = right > 0.0 && square > 0.0 ? std::sqrt(square) - end : right - mid;

  // In the plane: what the opening half kick has given too much.
  const Vec3 u = centres_mid - (lever_i * ma.w_mid + lever_j * mb.w_mid).cross(n), u_t = tangential(u, n);
  Vec3 drag = Vec3::Zero();
  if (law_.friction > 0.0) {
    const double limit = law_.friction * std::max(0.0, law_.k_n * overlap - memory.c_n * u.dot(n));
    drag = cut(law_.k_s * cut(laid_flat(memory.slide, n), limit / law_.k_s) + memory.c_s * u_t, limit);
  }
  const Vec3 due = 0.5 * (present - dt) * drag - mass * change * n;
  impulse(pair, due, lever_i * n.cross(due), lever_j * n.cross(due));
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
  const auto along = [&](const Vec3& e) { return mobility(pair, point_i, point_j, e); };
  const Vec3 e = n.unitOrthogonal();
  memory.c_n *= std::sqrt(law_.k_n / along(n));
  memory.c_s *= std::sqrt(law_.k_s * 2.0 / (along(e) + along(n.cross(e))));
}

double Collision::mobility(const Pair& pair, const Vec3& point_i, const Vec3& point_j, const Vec3& e) const {
  double sum = 0.0;
  for (const auto& [b, point] : {std::pair{balls_[pair.i].body, point_i}, {balls_[pair.j].body, point_j}}) {
    const Rigid& body = bodies_[b];
    const Vec3 moment = point.cross(e);
    sum += 1.0 / body.mass + moment.dot(spin(body, body.q, moment));
  }
  return sum;
}

}  // namespace cairn::lammps
