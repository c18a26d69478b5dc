using NUnit.Framework;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class EnvelopeTests
    {
        private readonly HapticEnvelope _envelope = ScriptableObject.CreateInstance<HapticEnvelope>();

        [TestCase(EnvelopeKind.Constant)]
        [TestCase(EnvelopeKind.Sine)]
        [TestCase(EnvelopeKind.Square)]
        [TestCase(EnvelopeKind.Pulse)]
        [TestCase(EnvelopeKind.Noise)]
        [TestCase(EnvelopeKind.Preset)]
        [TestCase(EnvelopeKind.Wave)]
        public void EachIsTaken(EnvelopeKind kind)
        {
            _envelope.Clip = Tone(48000, 2, 4800);
            _envelope.Kind = kind;
            Point point = new Point { RadiationPressure = 1.0, Envelope = _envelope.Message };
            Assert.AreEqual("", Checking.Problem(point));
            Assert.AreEqual(kind.ToString(), point.Envelope.GetType().Name);
            Assert.AreEqual("", _envelope.Problem);
        }

        [Test]
        public void ItIsMadeOnceForEachChange()
        {
            IEnvelope first = _envelope.Message;
            int version = _envelope.Version;
            Assert.IsTrue(ReferenceEquals(first, _envelope.Message));
            _envelope.Frequency = 40f;
            Assert.IsTrue(_envelope.Version > version);
            Assert.AreEqual(40.0, ((Sine)_envelope.Message).Frequency, 0.0);
        }

        [Test]
        public void WhatIsOutOfRangeIsBroughtIn()
        {
            _envelope.High = 7f;
            _envelope.Low = -1f;
            _envelope.Frequency = 1e6f;
            Assert.AreEqual("", Checking.Problem(new Point { RadiationPressure = 1.0, Envelope = _envelope.Message }));
        }

        [Test]
        public void AClipIsMonoAndSlowEnough()
        {
            string problem;
            Wave wave = AudioWave.Of(Tone(48000, 2, 4800), out problem);
            Assert.AreEqual(8000.0, wave.Rate, 0.0);
            Assert.AreEqual(800, wave.Samples.Numbers);
            Assert.AreEqual(0.25, wave.Samples.Single(0), 1e-6, "mean of 0.5 and 0");
        }

        [Test]
        public void AClipThatIsTooLongIsCutAndOneThatIsMissingIsTold()
        {
            string problem;
            Wave wave = AudioWave.Of(Tone(8000, 1, 300000), out problem);
            Assert.AreEqual(Protocol.MaxValues, wave.Samples.Numbers);
            Assert.AreEqual("its wave is cut after 25 s", problem);
            _envelope.Kind = EnvelopeKind.Wave;
            Assert.IsTrue(_envelope.Message is Constant);
            Assert.AreEqual("has no clip and no samples", _envelope.Problem);
            _envelope.Samples = new[] { 0f, 1f, -1f };
            Assert.AreEqual(1000.0, ((Wave)_envelope.Message).Rate, 0.0);
        }

        private static AudioClip Tone(int rate, int channels, int samples)
        {
            AudioClip clip = AudioClip.Create("tone", samples, channels, rate, false);
            float[] data = new float[samples * channels];
            for (int i = 0; i < data.Length; i += channels)
            {
                data[i] = 0.5f;
            }
            clip.SetData(data, 0);
            return clip;
        }
    }
}
