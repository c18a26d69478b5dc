using System;

namespace UnityEngine.Events
{
    public delegate void UnityAction<T>(T argument);

    [Serializable]
    public class UnityEvent<T>
    {
        private UnityAction<T> _calls;

        public void AddListener(UnityAction<T> call)
        {
            _calls += call;
        }

        public void RemoveListener(UnityAction<T> call)
        {
            _calls -= call;
        }

        public void Invoke(T argument)
        {
            _calls?.Invoke(argument);
        }
    }
}
