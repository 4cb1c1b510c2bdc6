#pragma once
// Packets: up to sixteen rays that run beside one another go down the tree together, each node fetched and tested once.
// A node's eight boxes are held against the interval of all rays at once (Boulos, Wald, Shirley, "Geometric and
// Arithmetic Culling Methods for Entire Ray Packets", 2006), what is left box by box against the rays, and where few
// rays are left in a subtree they go on one by one (Benthin et al., "Combining Single and Packet-Ray Tracing for
// Arbitrary Ray Distributions on the Intel MIC Architecture", 2012). The tests of triangles are those of single rays.
#include "bvh/trace_kernel.h"

namespace candela {
namespace {

// Where no more than these are left they go one by one.
constexpr int few_rays = 2;

template <class Do>
inline void each_lane(uint32_t lanes, Do&& act) {
  for (; lanes != 0; lanes &= lanes - 1) act(std::countr_zero(lanes));
}

// Rays side by side. Lanes without one hold a copy of the first.
struct RayLanes {
  alignas(64) float origin[3][packet_rays], direction[3][packet_rays], t_min[packet_rays], t_max[packet_rays];
  RayLanes(const KernelRay* rays, uint32_t lanes) {
    const uint32_t first = uint32_t(std::countr_zero(lanes));
    for (uint32_t from = 0; from < packet_rays; from += 4) {
      F4 begins[4], directions[4];
      for (uint32_t i = 0; i < 4; ++i) {
        const KernelRay& ray = rays[lanes >> (from + i) & 1u ? from + i : first];
        begins[i] = F4::load(ray.origin), directions[i] = F4::load(ray.direction);  // the fourth ones: limits of t
      }
      transpose(begins[0], begins[1], begins[2], begins[3]);
      transpose(directions[0], directions[1], directions[2], directions[3]);
      for (int a = 0; a < 3; ++a) begins[a].store(origin[a] + from), directions[a].store(direction[a] + from);
      begins[3].store(t_min + from), directions[3].store(t_max + from);
    }
  }
};

// Of every ray, what decides which rays make a packet: the signs of its direction and the largest axis of it.
struct RayKinds {
  uint32_t plain = ~0u;  // as is_plain
  uint32_t backwards[3], first, last;
  explicit RayKinds(const RayLanes& rays) {
    F16 size[3];
    for (int a = 0; a < 3; ++a) {
      const F16 direction = F16::load(rays.direction[a]);
      size[a] = absolute(direction);
      backwards[a] = less(direction, F16::all(0));
      plain &= less_equal(F16::all(0x1p-40f), size[a]) & less_equal(size[a], F16::all(0x1p40f)) &
               less_equal(absolute(F16::load(rays.origin[a])), F16::all(0x1p60f));
    }
    first = less(size[1], size[0]), last = ~less(size[2], max(size[0], size[1]));
  }
  // The rays of a lane's kind, itself among them; one that is not plain is alone.
  uint32_t like(int lane) const {
    if (!(plain >> lane & 1u)) return 1u << lane;
    const auto same = [&](uint32_t bits) { return bits >> lane & 1u ? bits : ~bits; };
    const uint32_t axis = same(last) & (last >> lane & 1u ? ~0u : same(first));
    return plain & axis & same(backwards[0]) & same(backwards[1]) & same(backwards[2]);
  }
};

struct WaitingRays {
  Waiting waiting;
  uint32_t lanes;
};

// Rays of one kind on their way.
class Packet {
 public:
  // beside: the rays of `lanes` side by side.
  Packet(const KernelTree& tree, KernelRay* rays, KernelSearch* const* searches, uint32_t lanes, RayLanes& beside)
      : tree_(tree), rays_(rays), searches_(searches), all_(lanes), lanes_(beside), axes_(first_direction()) {
    const F16 outwards = F16::all(0x1p-22f);
    for (int a = 0; a < 3; ++a) {
      const F16 origin = F16::load(lanes_.origin[a]), near = F16::all(1.0f) / F16::load(lanes_.direction[a]),
                far = near * F16::all(slab_slack);
      near.store(inverse_[a]);
      const F16 near_from = origin * near, far_from = origin * far;
      near_inverse_[a] = near, far_inverse_[a] = far;
      near_offset_[a] = F16::all(0) - near_from - absolute(near_from) * outwards;
      far_offset_[a] = absolute(far_from) * outwards - far_from;
      const uint32_t back = negative(lanes_.direction[a][0]);
      near_row_[a] = (2 * uint32_t(a) + back) * wide_children,
      far_row_[a] = (2 * uint32_t(a) + 1 - back) * wide_children;
      // The planes nearest to an origin of them all, by the slowest and the quickest ray; and the farthest ones.
      const float low = least(origin), high = largest(origin);
      near_origin_[a] = F8::all(back ? low : high), far_origin_[a] = F8::all(back ? high : low);
      slow_[a] = F8::all(least(near)), quick_[a] = F8::all(largest(near));
      far_slow_[a] = F8::all(least(far)), far_quick_[a] = F8::all(largest(far));
    }
    begin_ = F16::load(lanes_.t_min);
    interval_begin_ = F8::all(least(begin_));
    shorten();
    const F16 sz = F16::load(inverse_[axes_.z]);
    (F16::load(lanes_.direction[axes_.x]) * sz).store(sx_), (F16::load(lanes_.direction[axes_.y]) * sz).store(sy_);
  }

  void nearest() {
    WaitingRays stack[stack_size];
    WaitingRays* top = stack;
    uint32_t child = 0, lanes = all_;
    while (true) {
      while (!(child & leaf_bit) && std::popcount(lanes) > few_rays) {
        const WideNode& node = tree_.nodes[child];
        F8 begin;
        uint32_t met = meet_interval(node, begin);
        alignas(32) float near[wide_children];
        begin.store(near);
        WaitingRays* const first = top;
        for (; met != 0; met &= met - 1) {
          const int c = std::countr_zero(met);
          const uint32_t meeting = lanes & meet_box(node, c);
          if (meeting == 0) continue;
          prefetch<true>(tree_, node.child[c]);
          const WaitingRays next{waiting(near[c], node.child[c]), meeting};
          WaitingRays* at = top++;  // the farthest lowest
          for (; at > first && at[-1].waiting < next.waiting; --at) at[0] = at[-1];
          *at = next;
        }
        if (top == first) goto next;
        --top;
        child = child_of(top->waiting), lanes = top->lanes;
      }
      if (child & leaf_bit ? meet_leaf_rays<false>(child, lanes) != 0 : one_by_one<false>(child, lanes) != 0) shorten();
    next:
      do {
        if (top == stack) return;
        --top;
        lanes = top->lanes & less_equal(F16::all(near_of(top->waiting)), end_);
      } while (lanes == 0);
      child = child_of(top->waiting);
    }
  }

  // Returns those that have a hit.
  uint32_t any() {
    struct Entry {
      uint32_t child, lanes;
    } stack[stack_size];
    Entry* top = stack;
    uint32_t child = 0, lanes = all_, left = all_;
    while (true) {
      while (!(child & leaf_bit) && std::popcount(lanes) > few_rays) {
        const WideNode& node = tree_.nodes[child];
        F8 begin;
        Entry* const first = top;
        for (uint32_t met = meet_interval(node, begin); met != 0; met &= met - 1) {
          const int c = std::countr_zero(met);
          const uint32_t meeting = lanes & meet_box(node, c);
          if (meeting == 0) continue;
          prefetch<true>(tree_, node.child[c]);
          *top++ = {node.child[c], meeting};
        }
        if (top == first) goto next;
        --top;
        child = top->child, lanes = top->lanes;
      }
      left &= ~(child & leaf_bit ? meet_leaf_rays<true>(child, lanes) : one_by_one<true>(child, lanes));
      if (left == 0) return all_;
    next:
      do {
        if (top == stack) return all_ & ~left;
        --top;
        lanes = top->lanes & left;
      } while (lanes == 0);
      child = top->child;
    }
  }

 private:
  const float (&first_direction())[3] {
    for (int a = 0; a < 3; ++a) direction_[a] = lanes_.direction[a][0];
    return direction_;
  }

  void shorten() {
    end_ = F16::load(lanes_.t_max) * F16::all(slab_slack);
    interval_end_ = F8::all(largest(end_));
  }

  // Bit per child whose box any ray might meet, by the same operations as those of rays that are not plain, whose
  // roundings keep the order of what they round: no ray's own interval reaches beyond this one.
  uint32_t meet_interval(const WideNode& node, F8& near) const {
    const float* bounds = node.bounds[0];
    F8 begin[3], end[3];
#pragma GCC unroll 3
    for (int a = 0; a < 3; ++a) {
      const F8 low = F8::load(bounds + near_row_[a]) - near_origin_[a],
               high = F8::load(bounds + far_row_[a]) - far_origin_[a];
      begin[a] = min(low * slow_[a], low * quick_[a]);
      end[a] = max(high * far_slow_[a], high * far_quick_[a]);
    }
    near = max(max(begin[0], begin[1]), max(begin[2], interval_begin_));
    return less_equal(near, min(min(end[0], end[1]), min(end[2], interval_end_)));
  }

  // Bit per ray that meets the box of a child, as meet_boxes.
  uint32_t meet_box(const WideNode& node, int child) const {
    const float* bounds = node.bounds[0] + child;
    F16 begin[3], end[3];
#pragma GCC unroll 3
    for (int a = 0; a < 3; ++a) {
      begin[a] = multiply_add(F16::all(bounds[near_row_[a]]), near_inverse_[a], near_offset_[a]);
      end[a] = multiply_add(F16::all(bounds[far_row_[a]]), far_inverse_[a], far_offset_[a]);
    }
    return less_equal(max(max(begin[0], begin[1]), max(begin[2], begin_)), min(min(end[0], end[1]), min(end[2], end_)));
  }

  ShearedRays<F4> sheared_ray(int lane) const {
    return {axes_,
            {F4::all(lanes_.origin[axes_.x][lane]), F4::all(lanes_.origin[axes_.y][lane]),
             F4::all(lanes_.origin[axes_.z][lane])},
            F4::all(sx_[lane]),
            F4::all(sy_[lane]),
            F4::all(inverse_[axes_.z][lane]),
            F4::all(lanes_.t_min[lane])};
  }

  // Returns the rays that took a hit.
  template <bool any>
  uint32_t meet_leaf_rays(uint32_t leaf, uint32_t lanes) {
    const uint32_t first = first_of_leaf(leaf), count = count_of_leaf(leaf);
    uint32_t taken = 0;
    if (std::popcount(lanes) <= int(block_triangles)) {
      each_lane(lanes, [&](int lane) {
        const ShearedRays<F4> ray = sheared_ray(lane);
        bool met = false;
        for (uint32_t b = first; b < first + count && !(any && met); ++b)
          met |= meet_block<any>(tree_, tree_.blocks[b], ray, rays_[lane], *searches_[lane]);
        if (met) taken |= 1u << lane;
      });
    } else {
      const ShearedRays<F16> rays{
          axes_,
          {F16::load(lanes_.origin[axes_.x]), F16::load(lanes_.origin[axes_.y]), F16::load(lanes_.origin[axes_.z])},
          F16::load(sx_),
          F16::load(sy_),
          F16::load(inverse_[axes_.z]),
          begin_};
      for (uint32_t b = first; b < first + count; ++b)
        for (uint32_t i = 0; i < block_triangles && tree_.blocks[b].id[i] != no_triangle; ++i) {
          const TriangleBlock& block = tree_.blocks[b];
          const uint32_t met = meet<F16, any>(
              tree_, rays, [&](int k, uint32_t axis) { return F16::all(block.corner[k][axis][i]); },
              [&] { return any ? lanes & ~taken : lanes; }, F16::load(lanes_.t_max),
              [&](int lane) {
                return LaneHit{block.id[i], rays_[lane], *searches_[lane]};
              });
          taken |= met;
          if (!any) each_lane(met, [&](int lane) { lanes_.t_max[lane] = rays_[lane].t_max; });
        }
      return taken;
    }
    if (!any) each_lane(taken, [&](int lane) { lanes_.t_max[lane] = rays_[lane].t_max; });
    return taken;
  }

  template <bool any>
  uint32_t one_by_one(uint32_t child, uint32_t lanes) {
    uint32_t taken = 0;
    each_lane(lanes, [&](int lane) {
      KernelRay& ray = rays_[lane];
      const F4 origin = F4::load(ray.origin), inverse = F4::all(1.0f) / F4::load(ray.direction);
      const float before = ray.t_max;
      const bool ended =
          traverse<true, false, true>(tree_, child, ray, origin, inverse, *searches_[lane], any, nullptr);
      if (any ? ended : ray.t_max < before) taken |= 1u << lane;
      lanes_.t_max[lane] = ray.t_max;
    });
    return taken;
  }

  const KernelTree& tree_;
  KernelRay* rays_;
  KernelSearch* const* searches_;
  const uint32_t all_;
  RayLanes& lanes_;
  float direction_[3];
  ShearAxes axes_;
  F16 near_inverse_[3], far_inverse_[3], near_offset_[3], far_offset_[3], begin_, end_;
  F8 near_origin_[3], far_origin_[3], slow_[3], quick_[3], far_slow_[3], far_quick_[3], interval_begin_, interval_end_;
  uint32_t near_row_[3], far_row_[3];
  alignas(64) float inverse_[3][packet_rays], sx_[packet_rays], sy_[packet_rays];
};

uint32_t trace_packet(const KernelTree& tree, KernelRay* rays, KernelSearch* const* searches, uint32_t lanes,
                      bool any) {
  RayLanes beside(rays, lanes);
  const RayKinds kinds(beside);
  uint32_t held = lanes;  // by beside
  uint32_t ended = 0;
  while (lanes != 0) {
    const int first = std::countr_zero(lanes);
    const uint32_t alike = lanes & kinds.like(first);
    lanes &= ~alike;
    if (std::popcount(alike) <= few_rays) {
      each_lane(alike, [&](int lane) {
        if (trace<true>(tree, rays[lane], *searches[lane], any, nullptr)) ended |= 1u << lane;
      });
      continue;
    }
    if (alike != held) beside = RayLanes(rays, held = alike);
    Packet packet(tree, rays, searches, alike, beside);
    if (any)
      ended |= packet.any();
    else
      packet.nearest();
  }
  return ended;
}

}  // namespace
}  // namespace candela
