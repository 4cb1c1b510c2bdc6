#pragma once
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "graph/kept.h"
#include "graph/picture_parts.h"
#include "graph/plan.h"

namespace candela {

class CommandList;  // gpu/command_list.h; the graph only passes it on

using RecordFunction = std::function<void(CommandList&)>;

// Collects declarations; compile_graph turns them into a plan. Wrong use (a stale handle, a write of an imported
// resource, a use outside a pass, an access that does not fit an image or a buffer) is a defect of ours: it throws
// GraphError, which names pass and resource (tests refuse on purpose; in the program it ends as an internal error).
class GraphError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

class GraphBuilder {
 public:
  // A buffer that someone else owns, filled before the frame, or to fill: then this frame's passes write it first.
  enum class Import { filled, to_fill };
  BufferHandle import_buffer(BufferDesc desc, Import import = Import::filled);
  // An image that someone else owns and filled before, in the layout in which its format is sampled, as it is left.
  ImageHandle import_image(ImageDesc desc);
  // The image, all of which passes have written and none has read, depends on nothing but what `key` is a hash of:
  // compile_graph takes it from an earlier frame, or lets it outlive this one (gpu/kept_image.h). why: what is said of
  // passes that need not run then.
  void keep(ImageHandle image, const Hash128& key, std::string why);

  // Passes write and read parts of the image that are the same in any layered one, of other size and number of layers:
  // compile_graph puts one in its place that outlives the frame, with what earlier frames left in it, where there is
  // one. All of its uses are of all layers; one image of a graph at most.
  void pool(ImageHandle image);

  // Opens a pass; every declaration up to end_pass belongs to it. A frame's passes have different names: what stands in
  // a frame several times has a name for each instance, "blur.wide" (times, hashes and plans tell them apart).
  void begin_pass(std::string name, Queue queue = Queue::main);
  // A knob's value, as text, that the open pass works with: part of the plan and of its hash, whatever way it takes to
  // the shader.
  void knob(std::string name, std::string value);
  ImageHandle create(ImageDesc desc);  // version 0: nothing in it yet; must be written before it is read
  BufferHandle create(BufferDesc desc);
  // A required input. An empty handle marks the pass as left out ("needs depth, which ..."), and the call returns. A
  // zeroed buffer may be read at version 0. host_read is no access of a pass: sink() stands for it.
  void read(BufferHandle buffer, Access access, std::string_view what);
  // Of an image: which mips and layers, and what the shader sees them as. By default a 3D image is seen as one, a range
  // that holds all layers as what the image is, one layer as 2D, and others as an array; storage images and attachments
  // see cubes as arrays. Attachments and storage images are of one mip.
  void read(ImageHandle image, Access access, std::string_view what, ImageRange range = {},
            std::optional<ImageKind> view = {});
  // The same for an optional input: returns false for an empty handle, and nothing is declared.
  bool read_optional(ImageHandle image, Access access, ImageRange range = {}, std::optional<ImageKind> view = {});
  bool read_optional(BufferHandle buffer, Access access);
  // The new version. An empty handle counts as a missing required input, and comes back empty.
  ImageHandle write(ImageHandle image, Access access, ImageRange range = {}, std::optional<ImageKind> view = {});
  BufferHandle write(BufferHandle buffer, Access access);
  // Takes back ImageDesc::covered, for a reader who may see what a later pass covers.
  void clear_first(ImageHandle image);
  // Opens the next step of the pass: the graph orders steps like passes, with a barrier before each, and `record` is
  // called once for each (CommandList::step). The pass is timed once. What was declared before the first step belongs
  // to every step.
  void begin_step();
  PipelineHandle pipeline(ComputePipelineDesc desc);
  PipelineHandle pipeline(GraphicsPipelineDesc desc);
  PipelineHandle pipeline(RayPipelineDesc desc);  // needs an extension of the device
  // Closes the pass. Returns false when a required input was missing: then nothing of it is kept and the reason is.
  bool end_pass(RecordFunction record);

  // Both return the place among absences() that the handles which the pass would have given carry.
  int leave_out(std::string pass, std::string reason);
  int absent(std::string reason);
  int last_absence() const { return int(absences_.size()) - 1; }
  const std::vector<std::string>& absences() const { return absences_; }
  // An image that the frame can give under a layer's name (--layers, --view), where a pass of the frame makes one.
  void publish(std::string layer, ImageHandle image);
  const std::vector<std::pair<std::string, ImageHandle>>& published() const { return published_; }
  // Marks what the frame is for: these keep their producers alive. Buffers with memory host_read, usually. An empty
  // handle is no sink: what it stood for was left out.
  void sink(BufferHandle buffer);
  void sink(ImageHandle image);

  // Only a region of the picture is wanted (--region).
  void restrict_picture(const PictureParts& parts) { parts_ = parts; }
  const std::optional<PictureParts>& picture_parts() const { return parts_; }

  struct Pass {
    std::string name;
    Queue queue;
    std::vector<PlanUse> uses;
    std::vector<int> pipelines;  // into pipelines()
    std::vector<PlanKnob> knobs;
    RecordFunction record;
    int steps = 0;  // opened with begin_step
  };
  struct Resource {
    std::variant<ImageDesc, BufferDesc> desc;
    bool imported = false, to_fill = false;
    int version = 0;    // newest
    int creator = -1;   // declared pass that made it
    int left_out = -1;  // into left_out(): made by a pass that was left out; its handles are refused, the place stays
    std::vector<ImageRange> written;  // of images: what each version wrote, from version 1
    std::optional<Hash128> key;       // of images that may be kept; kept_reason with it
    std::string kept_reason;
    bool pooled = false;
    const std::string& name() const {
      return std::visit([](const auto& d) -> const std::string& { return d.name; }, desc);
    }
  };
  const std::vector<Pass>& passes() const { return passes_; }
  const std::vector<Resource>& resources() const { return resources_; }
  const std::vector<PipelineDesc>& pipelines() const { return pipelines_; }
  const std::vector<LeftOut>& left_out() const { return left_out_; }
  const std::vector<int>& sinks() const { return sinks_; }
  bool is_open() const { return open_; }  // a pass is being declared

 private:
  template <class Handle>
  Resource& resource_of(Handle handle);  // refuses stale, foreign and discarded handles
  struct Part {                          // of an image, as declared
    ImageRange range;
    std::optional<ImageKind> view;
  };
  template <class Handle>
  void read_any(Handle handle, Access access, std::string_view what, const Part& part = {});
  template <class Handle>
  Handle write_any(Handle handle, Access access, const Part& part = {});
  PlanUse use_of(const Resource& resource, PlanUse use, const Part& part) const;
  void check_written(const Resource& resource, const PlanUse& use) const;
  template <class Desc>
  int create_any(Desc desc);
  template <class Desc>
  PipelineHandle pipeline_any(Desc desc);
  void check_fits(const Resource& resource, Access access) const;
  void check_together(const Resource& resource, const PlanUse& use) const;
  void require_open(std::string_view call) const;
  std::string missing_reason(std::string_view what, int absence) const;
  void discard_pass();
  [[noreturn]] void refuse(std::string_view resource, std::string_view problem) const;

  std::vector<Pass> passes_;
  std::vector<Resource> resources_;
  std::vector<PipelineDesc> pipelines_;  // without duplicates
  std::vector<LeftOut> left_out_;
  std::vector<std::string> absences_;
  std::vector<std::pair<std::string, ImageHandle>> published_;
  std::vector<int> sinks_;
  bool open_ = false;  // passes_.back() is being declared
  std::optional<PictureParts> parts_;
  std::string missing_;  // why the open pass will be left out
};

struct CompiledGraph {
  FramePlan plan;
  std::vector<RecordFunction> record;         // parallel to plan.passes
  std::vector<std::pair<int, Hash128>> keys;  // of resources that are `keyed` (GraphBuilder::keep)
  Hash128 hash;                               // plan_hash() of the plan
};

// validate, prune (reference counts from the sinks; dropped passes are listed as "nothing reads NAME"), order
// (declaration order, which is topological), make physical (usage unions, lifetimes), alias (interval colouring,
// size-sorted first fit), barriers. kept: what other frames left; passes that would make it again are left out. Throws
// GraphError for a graph that cannot be right (read of a version that no pass made, cycle).
CompiledGraph compile_graph(const GraphBuilder& builder, const KeptKeys& kept = {});

// The named steps, for tests. prune says which declared passes stay; the others fill in more of the plan.
std::vector<bool> prune(const GraphBuilder& builder, std::vector<LeftOut>& left_out, const KeptKeys& kept = {});
void alias_memory(FramePlan& plan);
void place_barriers(FramePlan& plan);

}  // namespace candela
