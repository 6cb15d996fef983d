#include "cost/measure/front.h"

#include <cmath>
#include <limits>

#include "cost/measure/statistics.h"

namespace cost {

const char* word_for(Standing standing) {
    switch (standing) {
        case Standing::tied:
            return "tied";
        case Standing::dominated:
            return "dominated";
        case Standing::front:
            break;
    }
    return "front";
}

std::vector<Verdict> front(std::span<const double> errors,
                           std::span<const std::vector<double>> seconds) {
    const std::size_t n = errors.size();
    const auto error = [&](std::size_t i) {
        return std::isnan(errors[i]) ? std::numeric_limits<double>::infinity() : errors[i];
    };
    std::vector<Verdict> verdicts(n);
    for (std::size_t i = 0; i < n; ++i) {
        Verdict& v = verdicts[i];
        for (std::size_t j = 0; j < n; ++j) {
            if (j == i || !(error(j) <= error(i))) continue;
            const Estimate ratio = ratio_estimate(seconds[j], seconds[i], Confidence::deciding);
            Standing standing = Standing::front;
            if (ratio.high < 1)
                standing = Standing::dominated;
            else if (ratio.low <= 1 && error(j) < error(i))
                standing = Standing::tied;
            if (standing == Standing::front) continue;
            const bool stronger = standing > v.standing;
            if (stronger || (standing == v.standing && error(j) < error(v.by))) v = {standing, j};
        }
    }
    return verdicts;
}

}  // namespace cost
