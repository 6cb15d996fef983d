// The lists of stages of a picture's draws; draws that ask for the same share one.
#pragma once

#include <map>
#include <vector>

#include "kernels/kernels.h"
#include "rast/render.h"

namespace rast::detail {

class StageLists {
  public:
    // For the draws of a picture, whose lists before this are gone.
    void begin(const RenderPlan& plan, const ShadeFrame& frame);
    // Into a draw whose maps and light at vertices are bound: the lists that the plan has work for,
    // null else. `has_uvs`: the mesh has a first set of UVs.
    void bind(bool has_uvs, ShadeDraw& draw);

  private:
    const StageList* list_of(const StageRequest& request);

    const RenderPlan* plan_ = nullptr;
    std::vector<bool> local_lights_;
    std::map<StageRequest, StageList> lists_;
};

}  // namespace rast::detail
