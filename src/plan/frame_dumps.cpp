#include "plan/frame_dumps.h"

#include <charconv>

#include "base/text.h"
#include "passes/debug/dump.h"
#include "plan/plan_frame.h"

namespace candela {
namespace {

constexpr std::string_view where = "candela plan lists the passes and images";

// The image of that name that the pass writes, else one that it reads, else the one that a pass before wrote last.
int find_image(const GraphBuilder& builder, size_t pass, std::string_view image) {
  const auto among = [&](const GraphBuilder::Pass& p, bool writes) {
    for (auto use = p.uses.rbegin(); use != p.uses.rend(); ++use) {
      const GraphBuilder::Resource& resource = builder.resources()[size_t(use->resource)];
      if (use->writes == writes && resource.name() == image && std::holds_alternative<ImageDesc>(resource.desc))
        return use->resource;
    }
    return -1;
  };
  if (const int read = among(builder.passes()[pass], true); read >= 0) return read;
  if (const int written = among(builder.passes()[pass], false); written >= 0) return written;
  for (size_t before = pass; before-- > 0;)
    if (const int written = among(builder.passes()[before], true); written >= 0) return written;
  return -1;
}

const PlanPass* find_pass(const FramePlan& plan, std::string_view name) {
  for (const PlanPass& pass : plan.passes)
    if (pass.name == name) return &pass;
  return nullptr;
}

// Every name that a request could have, in the order of the plan: of the images that a pass uses.
std::vector<std::string> all_names(const FramePlan& plan, std::string_view of_pass = {}) {
  std::vector<std::string> names;
  for (const PlanPass& pass : plan.passes) {
    if (!of_pass.empty() && pass.name != of_pass) continue;
    for (const PlanUse& use : pass.uses) {
      const PlanResource& resource = plan.resources[size_t(use.resource)];
      std::string name = pass.name + "." + resource.name();
      if (resource.is_image() && std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(std::move(name));
    }
  }
  return names;
}

std::string nearest_text(std::string_view word, std::vector<std::string> names) {
  std::vector<std::string> nearest;
  for (int i = 0; i < 3; ++i) {
    const std::string next = nearest_name(word, names);
    if (next.empty()) break;
    nearest.push_back(next);
    std::erase(names, next);
  }
  return nearest.empty() ? std::string() : fmt::format("; the nearest: {}", joined(nearest));
}

// Why no kept pass and image have the request's name.
Error unknown(const DumpRequest& request, const GraphBuilder& builder, const FramePlan& plan) {
  const std::string& name = request.name;
  const auto error = [&](std::string text) { return Error{ErrorKind::usage, std::move(text), request.option}; };
  for (const LeftOut& left : plan.left_out)
    if (name.starts_with(left.pass + ".") && !find_pass(plan, left.pass))
      return error(
          fmt::format("'{}': the pass {} does not run in this frame: {} ({})", name, left.pass, left.reason, where));
  const PlanPass* named = nullptr;
  for (const PlanPass& pass : plan.passes)
    if (name.starts_with(pass.name + ".") && (!named || pass.name.size() > named->name.size())) named = &pass;
  if (!named)
    return error(fmt::format("no pass and image of this frame are '{}'{}; {}", name,
                             nearest_text(name, all_names(plan)), where));
  const std::string image = name.substr(named->name.size() + 1);
  for (const GraphBuilder::Resource& resource : builder.resources())
    if (resource.name() == image && std::holds_alternative<ImageDesc>(resource.desc))
      return error(
          fmt::format("'{}': nothing has written {} where the pass {} ends; {}", name, image, named->name, where));
  const std::vector<std::string> own = all_names(plan, named->name);
  std::string nearest = nearest_text(name, all_names(plan));
  if (nearest.empty() && !own.empty()) nearest = fmt::format("; the images of {}: {}", named->name, joined(own));
  return error(fmt::format("'{}': the frame has no image '{}'{}; {}", name, image, nearest, where));
}

Expected<void> check_part(const DumpRequest& request, const ImageDesc& image) {
  const bool volume = image.kind == ImageKind::d3;
  if (request.mip >= image.mips)
    return fail(ErrorKind::usage, request.option, "'{}': {} has {} mip{}, counted from 0", request.text(), image.name,
                image.mips, image.mips == 1 ? "" : "s");
  const uint32_t layers = volume ? mip_size(image.depth_px, request.mip) : image.layers;
  if (request.layer >= layers)
    return fail(ErrorKind::usage, request.option, "'{}': {} has {} {}{}, counted from 0", request.text(), image.name,
                layers, volume ? "slice" : "layer", layers == 1 ? "" : "s");
  return {};
}

// Of the passes up to `last`, the one that wrote the part last: it must be kept. What nothing reads is not made, and a
// dump does not make it either.
Expected<void> check_made(const DumpRequest& request, const GraphBuilder& builder, const FramePlan& plan, size_t last,
                          int image) {
  const ImageDesc& desc = std::get<ImageDesc>(builder.resources()[size_t(image)].desc);
  const GraphBuilder::Resource& resource = builder.resources()[size_t(image)];
  if (resource.imported && !resource.to_fill) return {};  // an earlier frame did
  const ImageRange part = ImageRange::layer(desc.kind == ImageKind::d3 ? 0 : request.layer, request.mip);
  for (size_t pass = last + 1; pass-- > 0;)
    for (const PlanUse& use : builder.passes()[pass].uses) {
      if (!use.writes || use.resource != image || !use.range.overlaps(part)) continue;
      if (find_pass(plan, builder.passes()[pass].name)) return {};
      return fail(ErrorKind::usage, request.option,
                  "'{}' is not made in this frame: nothing reads what {} writes to it; {}", request.text(),
                  builder.passes()[pass].name, where);
    }
  return fail(ErrorKind::usage, request.option, "'{}': no pass up to there writes that part of {}; {}", request.text(),
              desc.name, where);
}

}  // namespace

Expected<std::vector<FrameDump>> place_dumps(const std::vector<DumpRequest>& requests, const GraphBuilder& builder,
                                             const FramePlan& plan) {
  std::vector<FrameDump> dumps;
  for (const DumpRequest& request : requests) {
    const std::string& name = request.name;
    int image = -1;
    size_t declared = 0;
    for (const PlanPass& pass : plan.passes) {
      if (!name.starts_with(pass.name + ".")) continue;
      const std::string_view rest = std::string_view(name).substr(pass.name.size() + 1);
      if (const int found = find_image(builder, size_t(pass.declared), rest); found >= 0) {
        image = found;
        declared = size_t(pass.declared);
      }
    }
    if (image < 0) return std::unexpected(unknown(request, builder, plan));
    const ImageDesc& desc = std::get<ImageDesc>(builder.resources()[size_t(image)].desc);
    if (auto fine = check_part(request, desc); !fine) return std::unexpected(fine.error());
    if (auto made = check_made(request, builder, plan, declared, image); !made) return std::unexpected(made.error());
    dumps.push_back({request, builder.passes()[declared].name, desc, -1});
  }
  return dumps;
}

void add_dumps(Frame& frame, const std::string& pass, std::vector<FrameDump>& dumps) {
  const size_t place = frame.builder.passes().size() - 1;
  for (size_t i = 0; i < dumps.size(); ++i) {
    FrameDump& dump = dumps[i];
    if (dump.pass != pass) continue;
    const int image = find_image(frame.builder, place, dump.image.name);
    const ImageHandle handle{image, frame.builder.resources()[size_t(image)].version};
    const uint32_t layer = dump.image.kind == ImageKind::d3 ? 0 : dump.request.layer;
    dump.resource = frame.add(Dump{}, {handle, dump.request.mip, layer}, fmt::format("{}", i)).bytes.resource;
  }
}

}  // namespace candela
