/* Vectors of one number from each of several frames: what is done with one is done with all, and no lane knows of the
   others. So a frame comes out the same, to the bit, whatever the width and whoever its neighbours. */

#ifndef MOTIONEDIT_LANES_H
#define MOTIONEDIT_LANES_H

#include <math.h>
#include <stdint.h>

/* V: a number a lane. Mask: -1 or 0 a lane. ONE_LANE asks for plain numbers, WIDTH for more lanes than every processor
   has side by side. */
#if !defined(WIDTH) && defined(__GNUC__) && !defined(ONE_LANE)
#define WIDTH 2
#endif
#ifdef WIDTH
enum { LANES = WIDTH };
typedef double V __attribute__((vector_size(8 * WIDTH)));
typedef int64_t Mask __attribute__((vector_size(8 * WIDTH)));
#else
enum { LANES = 1 };
typedef double V;
typedef int64_t Mask;
#endif

/* One lane of a V or a Mask, to read or to write. */
#ifdef WIDTH
#define LANE(v, lane) ((v)[lane])
#define MASK_LANE(m, lane) ((m)[lane])
#else
#define LANE(v, lane) ((&(v))[lane])
#define MASK_LANE(m, lane) ((&(m))[lane])
#endif

#ifdef WIDTH
static inline V all(double x)
{
    return x - (V){0.0};
}
static inline Mask less(V a, V b)
{
    return a < b;
}
static inline Mask is_zero(V a)
{
    return a == 0.0;
}
static inline V choose(Mask which, V a, V b)
{
    return (V)((which & (Mask)a) | (~which & (Mask)b));
}
static inline int any(Mask m)
{
    int64_t found = 0;
    for (int i = 0; i < LANES; i++)
        found |= m[i];
    return found != 0;
}
static inline V root_of(V a)
{
    for (int i = 0; i < LANES; i++)
        a[i] = sqrt(a[i]);
    return a;
}
#else
static inline V all(double x)
{
    return x;
}
static inline Mask less(V a, V b)
{
    return -(Mask)(a < b);
}
static inline Mask is_zero(V a)
{
    return -(Mask)(a == 0.0);
}
static inline V choose(Mask which, V a, V b)
{
    return which ? a : b;
}
static inline int any(Mask m)
{
    return m != 0;
}
static inline V root_of(V a)
{
    return sqrt(a);
}
#endif

static inline V larger(V a, V b)
{
    return choose(less(b, a), a, b);
}

static inline V smaller(V a, V b)
{
    return choose(less(a, b), a, b);
}

static inline V size_of(V a)
{
    return larger(a, -a);
}

/* out += factor a, of n numbers */
static inline void add_multiple(V *out, V factor, const V *a, int n)
{
    for (int i = 0; i < n; i++)
        out[i] += factor * a[i];
}

/* a where the mask says so, else 0 */
static inline V only(Mask which, V a)
{
    return choose(which, a, all(0.0));
}

static inline Mask everywhere(void)
{
    return is_zero(all(0.0));
}

/* a . b of n numbers; two sums at a time do not wait for each other. */
static inline V dot_product(const V *a, const V *b, int n)
{
    V even = all(0.0), odd = even;
    int i = 0;
    for (; i + 2 <= n; i += 2)
        even += a[i] * b[i], odd += a[i + 1] * b[i + 1];
    if (i < n)
        even += a[i] * b[i];
    return even + odd;
}

/* The same in order: zeros between change no bit of it, as where other lanes have numbers. */
static inline V dot_in_order(const V *a, const V *b, int n)
{
    V sum = all(0.0);
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

#endif
